"""What an option is: one row that says its default, its values and its help. Everything else is read off the rows.

A row is a field of a frozen dataclass: of `remac_env.options.Options` (the kitchen), of `remac_agents.options` (the
agent) or of the benchmark's own (the run). Keywords and their documentation, flags and their help, keys of suite files,
entries of records and the errors about wrong values all come from it, so an option is added by adding its row.
"""

from __future__ import annotations

import functools
import inspect
import math
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, TypeVar

from remac_env.errors import OptionError, UnknownKeywordError, check_choice, real_number, whole_number
from remac_env.quoting import quoted

P = ParamSpec("P")
R = TypeVar("R")
First = TypeVar("First")
"""The type of the one argument that is no option."""

LONGEST = 60
"""Characters of a wrong value that an error shows."""

NEEDED: Any = inspect.Parameter.empty
"""The default of an option that has none: it must be given."""


class Values:
    """Which values an option takes: any, of whatever kind. `kind` is the type of what a command line reads."""

    kind: Any = str
    many: bool = False

    def check(self, name: str, value: Any) -> Any:
        """The value as it is used.

        Raises:
            UnknownNameError, OptionError: naming the option, the value and what is valid.
        """
        return value

    def read(self, text: Any) -> Any:
        """The value that a command line's text says.

        Raises:
            OptionError: as `check`, without the option's name.
        """
        return text


class Text(Values):
    """A text whose meaning is looked up where it is used."""


class Word(Text):
    """The same where nothing but a text is any use."""

    def check(self, name: str, value: Any) -> Any:
        """See Values."""
        if not isinstance(value, str):
            raise OptionError(f"{name} {quoted(value)} is not valid; valid: a text")
        return value


class Texts(Values):
    """Texts that add up where they are repeated, or stand with commas between them."""

    many = True


class File(Values):
    """A path."""

    kind = Path


class Switch(Values):
    """On or off."""

    kind = bool

    def check(self, name: str, value: Any) -> Any:
        """True or False as such: 1 is a number, and "no" would be taken for yes."""
        if not isinstance(value, bool):
            raise OptionError(f"{name} {quoted(value)} is not valid; valid: True or False")
        return value


@dataclass(frozen=True)
class Choice(Values):
    """One of these."""

    names: tuple[Any, ...]

    def check(self, name: str, value: Any) -> Any:
        """See Values."""
        check_choice(name, value, self.names)
        return value


@dataclass(frozen=True)
class Names(Values):
    """One or more of these, as one text: in their order, with commas between them."""

    names: tuple[str, ...]

    def check(self, name: str, value: Any) -> str:
        """See Values; several texts are as good as one with commas."""
        given = value.split(",") if isinstance(value, str) else value
        parts = given if isinstance(given, list | tuple) and given else [given]
        named = [part.strip() if isinstance(part, str) else part for part in parts]
        for part in named:
            check_choice(name, part, self.names)
        return ",".join(each for each in self.names if each in named)

    def read(self, text: Any) -> str:
        """See Values."""
        return self.check("", text)


@dataclass(frozen=True)
class Whole(Values):
    """A whole number in least..most; `valid` says it in other words."""

    least: int = 0
    most: int | None = None
    valid: str = ""
    kind = int

    def check(self, name: str, value: Any) -> int:
        """See Values."""
        try:
            return whole_number(name, value, self.least, self.most)
        except OptionError as error:
            if not self.valid:
                raise
            raise OptionError(f"{str(error).partition('valid: ')[0]}valid: {self.valid}") from error

    def read(self, text: Any) -> int:
        """See Values."""
        return self.check("", _number(text, int))


@dataclass(frozen=True)
class Real(Values):
    """A finite number in least..most."""

    least: float = 0.0
    most: float = math.inf
    kind = float

    def check(self, name: str, value: Any) -> float:
        """See Values."""
        return real_number(name, value, self.least, self.most)

    def read(self, text: Any) -> float:
        """See Values."""
        return float(self.check("", _number(text, float)))


@dataclass(frozen=True, kw_only=True)
class Row:
    """One option.

    Attributes:
        help: what it does, for documentation and command lines alike.
        default: NEEDED where it must be given.
        open: whether None is valid: it always is where it is the default.
        values: which values it takes.
        group: what kind of option it is within its home, such as "role" or "budget"; "" where there are no kinds.
        flag: how it is written on command lines; "": as its name.
        spoken: whether command lines and suites can say it: they cannot say an object, and no run of the benchmark
            takes what is there for learners, since planners see no masks, and agents need more than a vector.
    """

    help: str
    default: Any = None
    values: Values = Text()
    group: str = ""
    flag: str = ""
    spoken: bool = True
    open: bool = False

    def __post_init__(self) -> None:
        """None is valid where it is the default."""
        object.__setattr__(self, "open", self.open or self.default is None)

    def but(self, **changes: Any) -> Row:
        """The same option where a command has another default, or says more of it."""
        return replace(self, **changes)

    def check(self, name: str, value: Any) -> Any:
        """The value as it is used.

        Raises:
            UnknownNameError, OptionError: naming the option, the value and what is valid.
        """
        if value is None and self.open:
            return None
        try:
            return self.values.check(name, value)
        except OptionError as error:
            if not self.open:
                raise
            raise OptionError(f"{error}, or None") from error


def option(default: Any, help: str, values: Values | None = None, **more: Any) -> Any:  # noqa: A002 - as in help texts
    """A field of a frozen dataclass that is an option; `more`: further attributes of its Row."""
    row = Row(help=help, default=default, values=values or Text(), **more)
    return field(default=default, metadata={"row": row})


def rows(home: Any) -> dict[str, Row]:
    """The options of a dataclass by their names, in order."""
    return {each.name: each.metadata["row"] for each in fields(home) if "row" in each.metadata}


def same(home: Any, name: str, **changes: Any) -> Any:
    """A field that is an option of another dataclass; `changes`: what of its Row is otherwise here."""
    row = rows(home)[name].but(**changes)
    return field(default=row.default, metadata={"row": row})


def check_rows(made: Any) -> None:
    """Check the options of a frozen dataclass that is being made; to be called by its __post_init__.

    Raises:
        UnknownNameError, OptionError: naming the option, the value and what is valid.
    """
    for name, row in rows(made).items():
        object.__setattr__(made, name, row.check(name, getattr(made, name)))


def takes_options(
    home: Callable[P, object],
) -> Callable[[Callable[Concatenate[First, ...], R]], Callable[Concatenate[First, P], R]]:
    """A function whose further keywords are the options of `home`, a dataclass: by its signature, which type checkers
    see too, and in its docstring, in which they stand in place of "{options}"."""

    def wrap(function: Callable[Concatenate[First, ...], R]) -> Callable[Concatenate[First, P], R]:
        own = [p for p in inspect.signature(function).parameters.values() if p.kind is p.POSITIONAL_OR_KEYWORD]
        signature = inspect.Signature([*own, *inspect.signature(home).parameters.values()])
        told = f"{function.__module__.partition('.')[0]}.{function.__name__}"

        @functools.wraps(function)
        def called(*args: Any, **given: Any) -> R:
            for name in given:
                if name not in signature.parameters:
                    valid = ", ".join(signature.parameters)
                    raise UnknownKeywordError(f"unknown keyword of {told} {quoted(name)}; valid: {valid}")
            return function(**signature.bind(*args, **given).arguments)  # type: ignore[call-arg]

        called.__signature__ = signature  # type: ignore[attr-defined]
        if called.__doc__ is not None:
            called.__doc__ = called.__doc__.replace("{options}", described(home).lstrip())
        return called

    return wrap


def described(home: Any, *, indent: int = 8) -> str:
    """The options of a dataclass as the lines of a docstring."""
    edge = " " * indent
    lines = [f"{name}: {_going_on(told(row))}" for name, row in rows(home).items()]
    return "\n".join(
        textwrap.fill(line, 120, initial_indent=edge, subsequent_indent=f"{edge}    ", break_on_hyphens=False)
        for line in lines
    )


def told(row: Row) -> str:
    """What an option does, and the range of a number where its help does not say it."""
    least, most = getattr(row.values, "least", None), getattr(row.values, "most", None)
    if least is None or f"{least} to " in row.help or f"{least}, " in row.help or f"{least}: " in row.help:
        return row.help
    return f"{row.help} {least:g} {f'to {most:,g}' if most and most < 1e9 else 'or more'}."


def _going_on(sentence: str) -> str:
    """A sentence as it stands behind a colon; a first word in capitals keeps them."""
    return sentence if sentence[1:2].isupper() else sentence[0].lower() + sentence[1:]


def _number(text: Any, kind: type) -> Any:
    """What a text says; the text itself where it says no number."""
    if not isinstance(text, str):
        return text
    try:
        return kind(text)
    except ValueError:
        return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
