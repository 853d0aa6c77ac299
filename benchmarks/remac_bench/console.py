"""What commands have in common: consoles, and errors of users as one line."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable
from typing import ParamSpec, TypeVar

import typer
from rich.console import Console

from remac_bench.errors import RecordFileError, UsageError
from remac_env.errors import KitchenFileError, OptionError, RemacError, UnknownNameError

P = ParamSpec("P")
R = TypeVar("R")

USAGE, FAILED, INTERRUPTED = 2, 1, 130
"""Exit codes: a command line to be mended; something went wrong; Ctrl-C."""

MARKS = {True: "[green]ok[/green]", False: "[red]problem[/red]", None: "[dim]-[/dim]"}
"""How findings are marked: it works, it does not, or nothing is there and nothing is wrong."""

_USAGE_ERRORS = (UsageError, UnknownNameError, OptionError, KitchenFileError, RecordFileError)
_WIDTH = 120


def console(*, stderr: bool = False) -> Console:
    """A console that keeps tables whole where there is no terminal to say how wide it is."""
    stream = sys.stderr if stderr else sys.stdout
    width = None if stream.isatty() or "COLUMNS" in os.environ else _WIDTH
    return Console(stderr=stderr, width=width, highlight=False)


def clean_errors(command: Callable[P, R]) -> Callable[P, R]:
    """Turn the project's own errors into one line on stderr and an exit code; others keep their traceback."""

    @functools.wraps(command)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return command(*args, **kwargs)
        except _USAGE_ERRORS as error:
            raise _exit(str(error), USAGE) from error
        except RemacError as error:
            raise _exit(str(error), FAILED) from error

    return wrapped


def _exit(message: str, code: int) -> typer.Exit:
    typer.echo(f"error: {plain(message)}", err=True)
    return typer.Exit(code)


def plain(message: str) -> str:
    """A message as one line: what users and planners wrote comes back in it, with no control characters."""
    return " ".join("".join(c if c.isprintable() else " " for c in message).split())
