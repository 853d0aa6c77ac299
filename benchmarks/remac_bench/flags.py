"""The one table of what command lines can say: a Flag for every row of the kitchen, the agent, the run and commands.

Rows lie where the option has its effect: `remac_env.options.Options`, `remac_agents.options.AgentOptions`,
`agents.Access`, `settings.Settings`, and `command_rows` and `script_rows` for what one command alone is asked. A
command says by name which flags it takes; nothing about a flag is said anywhere else.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import GenericAlias
from typing import Annotated, Any, get_type_hints

import typer

from remac_agents.options import AgentOptions
from remac_bench.command_rows import ROWS as COMMANDS
from remac_bench.completion import completer
from remac_bench.console import clean_errors
from remac_bench.playing import agents
from remac_bench.playing.agents import Access
from remac_bench.playing.settings import Settings
from remac_bench.script_rows import ROWS as SCRIPTS
from remac_env.errors import OptionError
from remac_env.option_rows import Choice, Row, Texts, Values, rows
from remac_env.options import MAX_ROBOTS, Options

HOMES: dict[str, Any] = {"kitchen": Options, "agent": AgentOptions, "access": Access, "settings": Settings}
"""Dataclass by name of home. A keyword that the agent has too is written --agent-... ."""

ASKED: dict[str, dict[str, Any]] = {
    "kitchen.robots": {
        "default": None,
        "help": f"1 to {MAX_ROBOTS}; by default the method's own: REMAC and SMART-LLM 2, others 1.",
    },
    "agent.model": {
        "values": Texts(),
        "flag": "--model",
        "help": "provider:model or provider:model,option=value: an entry that fills every role that speaks; may be "
        "repeated.",
    },
    "settings.workers": {"default": None},
    "settings.preflight": {"default": True},
}
"""What command lines have otherwise than keywords: what is not said follows from the method, the suite or the machine.
"""

NAMES = {"kitchen.max_seconds": "episode_seconds"}
"""What command lines call a keyword otherwise, because another home had its name first."""

_PANELS = {"kitchen": "The kitchen", "agent": "The agent", "models": "Language models", "run": "The run"}


@dataclass(frozen=True, kw_only=True)
class Flag:
    """An option as command lines say it.

    Attributes:
        parameter: by which a command gets it.
        home: a key of HOMES, or a command; `keyword`: by which that knows it.
    """

    parameter: str
    home: str
    keyword: str
    row: Row

    @property
    def written(self) -> str:
        """As a command line has it: "--max-rounds"."""
        return self.row.flag.partition(" ")[0].partition("/")[0] or f"--{self.parameter.replace('_', '-')}"

    @property
    def panel(self) -> str | None:
        """The heading under which help shows it."""
        if self.row.group in ("model", "models", "reach", "budget"):
            return _PANELS["models"]
        return _PANELS.get(self.home, _PANELS["run"] if self.home in ("access", "settings", "run") else None)

    @property
    def declared(self) -> inspect.Parameter:
        """The same for typer."""
        row = self.row
        more = {**parsed(row.values), "autocompletion": completer(self.home, self.keyword, row.values)}
        told = typer.Option(*row.flag.split(), help=row.help, rich_help_panel=self.panel, **more)
        kind: Any = GenericAlias(list, (row.values.kind,)) if row.values.many else row.values.kind
        default = (list(row.default) or None) if isinstance(row.default, tuple) else row.default
        annotation: Any = Annotated[kind | None if default is None else kind, told]
        return inspect.Parameter(self.parameter, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def parsed(values: Values) -> dict[str, Any]:
    """Keywords of typer.Option for numbers, which are read with their ranges; none for others."""
    if values.kind not in (int, float):
        return {}

    def parse(text: object) -> Any:
        try:
            return values.read(text)
        except OptionError as error:
            raise typer.BadParameter(str(error).strip()) from error

    return {"parser": parse, "metavar": "INTEGER" if values.kind is int else "FLOAT"}


def _of_homes() -> Iterator[tuple[str, Flag]]:
    for home, made in HOMES.items():
        for name, row in rows(made).items():
            if row.spoken and not (home == "access" and name in rows(AgentOptions)):
                also = {"default": None} if home == "agent" and row.values.kind is not bool else {}
                said = row.but(**{**also, **ASKED.get(f"{home}.{name}", {})})
                shared = home == "agent" and name in rows(Options) and f"kitchen.{name}" not in NAMES
                parameter = NAMES.get(f"{home}.{name}", f"agent_{name}" if shared else name)
                yield parameter, Flag(parameter=parameter, home=home, keyword=name, row=said)


def _of_commands() -> Iterator[tuple[str, Flag]]:
    for name, row in {**COMMANDS, **SCRIPTS}.items():
        home, _, parameter = name.partition(".")
        yield name, Flag(parameter=parameter, home=home, keyword=parameter, row=row)


TABLE: dict[str, Flag] = {**dict(_of_homes()), **dict(_of_commands())}
"""Name -> flag; those of one command alone are named COMMAND.PARAMETER."""


def of(home: str) -> tuple[str, ...]:
    """The names of all flags of a home."""
    return tuple(name for name, flag in TABLE.items() if flag.home == home)


REACH = ("base_url", "providers", "via", "cassette", "replay", "preflight", *agents.BUDGET)
"""Flags of commands that ask language models."""

RUN = (*of("run"), "model", *REACH, *of("settings"), *of("access"), *of("kitchen"), *of("agent"))
"""Those of `remac bench run`: every one but those of other commands."""

FROZEN = (
    *("run.tasks", "run.methods", "run.seeds", "iterations"),
    *(name for name in of("agent") if TABLE[name].keyword in agents.BOUNDS),
    *(name for name in of("kitchen") if name not in ("backend", "render_mode")),
)
"""Flags that do not go with a suite, which says these things itself."""


def takes(*names: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """A command with these flags, which it gets as keywords, and its own arguments; errors are reported in one line.

    Raises:
        TypeError: if it has a keyword that is not one of them.
    """
    flags = {TABLE[name].parameter: TABLE[name] for name in dict.fromkeys(names)}

    def wrap(command: Callable[..., None]) -> Callable[..., None]:
        own, hints = [], get_type_hints(command, include_extras=True)
        for name, each in inspect.signature(command).parameters.items():
            if each.kind is each.KEYWORD_ONLY and name not in flags:
                raise TypeError(f"{command.__name__}: {name!r} is not a flag that it takes; valid: {', '.join(flags)}")
            if each.kind is each.POSITIONAL_OR_KEYWORD:
                own.append(each.replace(annotation=hints[name]))
        made = clean_errors(_choosing(command, flags))
        signature = inspect.Signature([*own, *(flag.declared for flag in flags.values())])
        made.__signature__ = signature  # type: ignore[attr-defined]
        made.__annotations__ = {name: each.annotation for name, each in signature.parameters.items()}
        return made

    return wrap


def _choosing(command: Callable[..., None], flags: Mapping[str, Flag]) -> Callable[..., None]:
    """The command, which is not run where one of its flags is none of the choices that its row names.

    Numbers are checked as they are parsed (`parsed`).
    """
    chosen = {name: flag for name, flag in flags.items() if isinstance(flag.row.values, Choice)}

    @functools.wraps(command)
    def checked(*args: Any, **given: Any) -> None:
        for name in (name for name in chosen if name in given):
            chosen[name].row.check(chosen[name].written.lstrip("-").replace("-", "_"), given[name])
        command(*args, **given)

    return checked


def pick(given: Mapping[str, Any], home: str) -> dict[str, Any]:
    """Keyword of a home -> the value of its flag, from what a command was given."""
    return {flag.keyword: given[flag.parameter] for flag in TABLE.values() if flag.home == home}
