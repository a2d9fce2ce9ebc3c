"""docs/architecture.md says what the code says."""

from __future__ import annotations

from docs import make_architecture as made


def test_the_picture_and_the_table_are_of_this_code() -> None:
    assert made.PICTURE.read_text(encoding="utf-8") == made.picture()
    text = made.PAGE.read_text(encoding="utf-8")
    assert text == made.page(text)


def test_every_package_says_what_it_is_for() -> None:
    packages = [name for layer in made.layers() for name in layer]
    assert all(made.purpose(name).endswith((".", ":")) for name in packages), packages
    assert "`mechanics`" in made.table()
