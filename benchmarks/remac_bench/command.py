"""How every command of `remac` reads its line: numbers with their ranges, nothing given twice, errors in one line."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from typing import Any, NoReturn

import typer
from typer.core import TyperCommand

from remac_bench.console import USAGE, clean_errors, plain
from remac_bench.errors import UsageError
from remac_env.errors import OptionError, real_number, whole_number

LONGEST = 60
"""Characters of a wrong value that an error shows."""

_UsageError: Any = typer.BadParameter.__mro__[1]  # typer has a click of its own, or not: it depends on its version


class Command(TyperCommand):
    """A command that refuses an option given twice where only one value counts, and says what is wrong in one line."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """See typer."""
        try:
            _, _, given = self.make_parser(ctx).parse_args(args=list(args))
            twice = [p for p, times in Counter(given).items() if times > 1 and not getattr(p, "multiple", False)]
            options = [param for param in twice if param.param_type_name == "option"]
            if options and not any(param.is_eager for param in given):  # --help is for everybody
                _refuse(f"{options[0].opts[0]} is given twice; valid: once")
            return list(super().parse_args(ctx, args))
        except _UsageError as error:
            if type(error).__name__ == "NoArgsIsHelpError":
                raise
            _refuse(f"{error.format_message()} (--help lists the options)")


def whole(least: int = 0, most: int | None = None, *, valid: str = "") -> dict[str, Any]:
    """Keywords of typer.Option for a whole number in least..most; `valid` says it in other words."""

    def read(text: object) -> int:
        try:
            return whole_number("", _number(text, int), least, most)
        except OptionError as error:
            raise OptionError(f"{str(error).partition('valid: ')[0]}valid: {valid}" if valid else str(error)) from error

    return {"parser": _reader(read), "metavar": "INTEGER"}


def real(least: float = 0.0, most: float = math.inf) -> dict[str, Any]:
    """Keywords of typer.Option for a finite number in least..most."""

    def read(text: object) -> float:
        return float(real_number("", _number(text, float), least, most))

    return {"parser": _reader(read), "metavar": "FLOAT"}


def joined(given: list[str] | None, kind: str) -> str | None:
    """The texts of an option that may be repeated as one, with commas between them; None where it was not given.

    Raises:
        UsageError: where it was given without a value.
    """
    if not given:
        return None
    if any(not text.strip() for text in given):
        raise UsageError(f"{kind} {given!r} name nothing; give one or more, with commas between them")
    return ",".join(given)


def run_script(main: Callable[..., Any]) -> None:
    """Run a script's only function as a command of this kind."""
    app = typer.Typer(add_completion=False)
    app.command(cls=Command)(clean_errors(main))
    app()


def _number(text: object, kind: type) -> object:
    """What a text says; the text itself where it says no number."""
    if not isinstance(text, str):
        return text
    try:
        return kind(text)
    except ValueError:
        return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def _reader(read: Callable[[object], Any]) -> Callable[[object], Any]:
    def parse(text: object) -> Any:
        try:
            return read(text)
        except OptionError as error:
            raise typer.BadParameter(str(error).strip()) from error

    return parse


def _refuse(message: str) -> NoReturn:
    typer.echo(f"error: {plain(message)}", err=True)
    raise typer.Exit(USAGE)
