"""The grammar of names: safe as a Python module, a C prefix and a folder."""

from __future__ import annotations

import keyword
import re
import sys
from collections.abc import Sequence

from pne_sym.model.entry import Entry

LONGEST = 40
LONGEST_OF_PART = 20
GRAMMAR = r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*"
"""Single underscores only: C++ keeps names with two for itself."""
_GRAMMAR = re.compile(GRAMMAR)
_EXPECTED = "a lower-case letter, then lower-case letters, digits, single underscores between them"
_COMMANDS = "list check diff explain new draw all"
_C_AND_CPP = """
    alignas alignof and_eq asm atomic_cancel auto bitand bitor bool case catch char char8_t
    char16_t char32_t compl concept const const_cast consteval constexpr constinit co_await
    co_return co_yield decltype default delete do double dynamic_cast enum explicit export
    extern final float friend goto inline int long main mutable namespace new noexcept not_eq
    nullptr operator or_eq override private protected public register reinterpret_cast requires
    restrict short signed sizeof static static_assert static_cast struct switch template this
    thread_local throw true false typedef typeid typename typeof union unsigned using virtual void
    volatile wchar_t xor xor_eq
"""
_C_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal
    stdarg stdbool stddef stdint stdio stdlib string tgmath time wchar wctype
"""
_POSIX_HEADERS = """
    aio alloca cpio dirent dlfcn endian fcntl features fmtmsg fnmatch ftw glob grp iconv langinfo
    libgen malloc memory monetary mqueue ndbm netdb nl_types poll pthread pwd regex sched search
    semaphore spawn strings stropts syslog tar termios trace ulimit unistd utime utmpx wordexp
"""
_RESERVED: tuple[tuple[str, frozenset[str]], ...] = (
    ("a command of pne-gen", frozenset(_COMMANDS.split())),
    ("a Python keyword", frozenset((*keyword.kwlist, *keyword.softkwlist))),
    ("a keyword of C or C++", frozenset(_C_AND_CPP.split())),
    ("a standard header of C", frozenset(_C_HEADERS.split())),
    ("a header of POSIX", frozenset(_POSIX_HEADERS.split())),
    ("a Python module", sys.stdlib_module_names | {"numpy"}),
)
_DEVICES = re.compile(r"con|prn|aux|nul|com[0-9]|lpt[0-9]")


def read_name(entry: Entry) -> str:
    """The name of a manipulator.

    Raises:
        SpecError: outside the grammar, or a word with another meaning: the
            generated module and header must not shadow those of the languages.
    """
    name = entry.text()
    if len(name) > LONGEST or not _GRAMMAR.fullmatch(name):
        raise entry.fault(f"{_EXPECTED}; at most {LONGEST} characters")
    reason = _reserved_as(name)
    if reason:
        raise entry.fault(f"another name: '{name}' is {reason}")
    return name


def read_type_name(entry: Entry, name: str) -> str:
    """The name of a leg type: the same grammar, no reserved words.

    Raises:
        SpecError: outside the grammar.
    """
    if len(name) > LONGEST or not _GRAMMAR.fullmatch(name):
        raise entry.fault(
            _EXPECTED,
            problem=f"leg type named {name[:LONGEST]!r}",
        )
    return name


def read_part_name(entry: Entry) -> str:
    """The name of a leg or a joint: the same grammar, and short, as names are made of it.

    Raises:
        SpecError: outside the grammar.
    """
    name = entry.text()
    if len(name) > LONGEST_OF_PART or not _GRAMMAR.fullmatch(name):
        raise entry.fault(f"{_EXPECTED}; at most {LONGEST_OF_PART} characters")
    return name


def refuse_twice(entry: Entry, names: Sequence[str], part: str) -> None:
    """Refuse legs, or joints of a leg, that would be called alike.

    Args:
        entry: the list.
        names: of all, in order; "" for what is called by its number.
        part: the word that stands before numbers, leg or joint.

    Raises:
        SpecError: two of them have one name.
    """
    called = [name or f"{part}{k}" for k, name in enumerate(names, 1)]
    for k, name in enumerate(called):
        if name in called[:k]:
            problem = f"{part}s {called.index(name) + 1} and {k + 1} are both called '{name}'"
            raise entry.fault(f"a name of its own for each {part}", problem=problem)


def reserved() -> list[str]:
    """Reserved words that do not depend on the version of Python, in alphabetical order."""
    return sorted(
        {*_COMMANDS.split(), *_C_AND_CPP.split(), *_C_HEADERS.split(), *_POSIX_HEADERS.split()}
    )


def _reserved_as(name: str) -> str:
    if _DEVICES.fullmatch(name):
        return "a device name on Windows"
    return next((reason for reason, words in _RESERVED if name in words), "")
