"""How every command of `remac` reads its line: numbers with their ranges, nothing given twice, errors in one line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, NoReturn

import typer
from typer.core import TyperCommand

from remac_bench.console import USAGE, plain
from remac_bench.errors import UsageError

_UsageError: Any = typer.BadParameter.__mro__[1]  # typer has a click of its own, or not: it depends on its version


class Command(TyperCommand):
    """A command that refuses an option given twice where only one value counts, and says what is wrong in one line."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """See typer."""
        if ctx.resilient_parsing:  # a line that is being completed may be wrong in any way as yet
            return list(super().parse_args(ctx, args))
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
    """Run a script's only function, which `flags.takes` has made a command, as one of this kind."""
    app = typer.Typer(add_completion=False)
    app.command(cls=Command)(main)
    app()


def _refuse(message: str) -> NoReturn:
    typer.echo(f"error: {plain(message)}", err=True)
    raise typer.Exit(USAGE)
