"""What is printed, line by line."""

from __future__ import annotations

import pytest

from pne_sym.cli.console import Report, print_message


@pytest.mark.parametrize("kind", ["error: ", "warning: "])
def test_control_characters_are_escaped(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    print_message(kind, "a\x1b[31mb\x07\x9b[tab\t")
    assert capsys.readouterr().err.split(": ", 2)[2] == "a\\x1b[31mb\\x07\\x9b[tab\t\n"


def test_markup_in_a_message_is_text(capsys: pytest.CaptureFixture[str]) -> None:
    Report().line("[bold]robot[/nothing]")
    Report().difference("+[red]")
    assert capsys.readouterr().out == "[bold]robot[/nothing]\n+[red]\n"


def test_quiet_tells_differences_but_no_results(capsys: pytest.CaptureFixture[str]) -> None:
    report = Report(quiet=True)
    report.line("wrote")
    report.difference("changed")
    with report.progress(1) as step:
        step.working_on("robot")
        step.done()
    assert capsys.readouterr().out == "changed\n"
