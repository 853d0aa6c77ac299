"""What commands have in common: consoles, and errors of users as one line."""

from __future__ import annotations

import errno
import functools
import io
import os
import re
import sys
from collections.abc import Callable
from typing import ParamSpec, TextIO, TypeVar

import typer
from rich.cells import cell_len
from rich.console import Console

from remac_bench.errors import RecordFileError, UsageError
from remac_env.errors import KitchenFileError, OptionError, RemacError, UnknownNameError

P = ParamSpec("P")
R = TypeVar("R")

FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
"""What a stream says that leads to a full disk."""

USAGE, FAILED, INTERRUPTED = 2, 1, 130
"""Exit codes: a command line to be mended; something went wrong; Ctrl-C."""

MARKS = {True: "[green]ok[/green]", False: "[red]problem[/red]", None: "[dim]-[/dim]"}
"""How findings are marked: it works, it does not, or nothing is there and nothing is wrong."""

_USAGE_ERRORS = (UsageError, UnknownNameError, OptionError, KitchenFileError, RecordFileError)
_WIDTH = 120
"""Columns where nobody says how many there are."""

_LEAST, _MOST = 60, 1000
"""Columns between which tables can be laid out; a narrower terminal breaks the lines itself."""

_WORDS, _PARTS = re.compile(r"\s*\S+\s*"), re.compile(r"[^,/:=]*[,/:=]+\s*|[^,/:=]+")
_HEIGHT = 40  # given together with the width, or rich believes terminals that say nothing sensible


def console(*, stderr: bool = False) -> Console:
    """A console that keeps tables and texts as they are, whatever the terminal says of itself."""
    width = _width(sys.stderr if stderr else sys.stdout)
    return Console(stderr=stderr, width=width, height=_HEIGHT, highlight=False, emoji=False)


def _width(stream: TextIO) -> int:
    """Columns: what COLUMNS says, else the terminal, within bounds; _WIDTH where neither says a number from 1."""
    said = os.environ.get("COLUMNS", "").strip()
    columns = int(said) if said.isascii() and said.isdigit() and len(said) < 10 else 0
    if not columns and stream.isatty():
        try:
            columns = os.get_terminal_size(stream.fileno()).columns
        except (OSError, ValueError):
            columns = 0  # it calls itself a terminal and is none
    return min(max(columns, _LEAST), _MOST) if columns else _WIDTH


def say(line: str, *, stderr: bool = False) -> None:
    """Print a line: a terminal gets it in lines that end with a word, a file or another program as it is."""
    made = console(stderr=stderr)
    for part in broken(line, made.width) if made.is_terminal else [line]:
        made.print(part, markup=False, soft_wrap=True)


def broken(text: str, width: int) -> list[str]:
    """Lines of at most so many columns that end with a word, or, where one is wider than a line, with a part of it.

    Parts end with a comma, a slash, a colon or an equals sign; one that is wider than a line stays whole.
    """
    lines: list[str] = []
    for line in text.split("\n"):
        made = ""
        for word in _WORDS.findall(line):
            for part in _PARTS.findall(word) if cell_len(word.rstrip()) > width else [word]:
                if made.strip() and cell_len(made + part.rstrip()) > width:
                    lines.append(made.rstrip())
                    made = ""
                made += part
        lines.append(made.rstrip())
    return lines


def tame_columns() -> None:
    """Give the help texts, which others print, a width that they can take, where COLUMNS says one that they cannot."""
    if "COLUMNS" in os.environ:
        os.environ["COLUMNS"] = str(_width(sys.stdout))


def fill_streams() -> None:
    """Lead streams that are closed nowhere, as `>&-` leaves them: the next file would get their numbers, and whatever
    is printed would be written into it."""
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free: this one
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, mode, closefd=False))  # noqa: SIM115 - it stays open


def check_folder() -> None:
    """Refuse a working folder that is gone, which many modules cannot even be imported in.

    Raises:
        SystemExit: with one line.
    """
    try:
        os.getcwd()
    except OSError as error:
        typer.echo(f"error: the working folder is not there: {error.strerror}; go to one that is", err=True)
        raise SystemExit(USAGE) from error


def speak_plainly() -> None:
    """Let a stream that cannot write a letter escape it, rather than end the command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors="backslashreplace")


def clean_errors(command: Callable[P, R]) -> Callable[P, R]:
    """Turn the project's own errors into one line on stderr and an exit code; others keep their traceback."""

    @functools.wraps(command)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        speak_plainly()
        try:
            return command(*args, **kwargs)
        except _USAGE_ERRORS as error:
            raise _exit(str(error), USAGE) from error
        except RemacError as error:
            raise _exit(str(error), FAILED) from error
        except OSError as error:
            if error.errno not in FULL or error.filename is not None:
                raise
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left is not tried again at the end
            raise _exit(f"the output cannot be written: {error.strerror}", FAILED) from error

    return wrapped


def _exit(message: str, code: int) -> typer.Exit:
    typer.echo(f"error: {plain(message)}", err=True)
    return typer.Exit(code)


def plain(message: str) -> str:
    """A message as one line: what users and planners wrote comes back in it, with no control characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in message).split())
