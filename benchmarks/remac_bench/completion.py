"""What the Tab key completes behind an option: the choices of its row, or the names that there are just then.

The names of tasks, roles, methods, suites, styles and layouts come from where they are registered, so that those of
installed packages are among them. What only a file named on the line would add is not: that file is not run because of
a key. Templates have spaces in their names, which shells do not complete well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

import remac_agents
import remac_env
from remac_agents.wiring.catalogue import ROLES
from remac_bench.playing import suites
from remac_env.lowlevel.names import skills
from remac_env.option_rows import Choice, Names, Values
from remac_env.skill_sources import LEARNED, SCRIPTED
from remac_env.tasks.generated import SPEC as GENERATED

Complete = Callable[[str], list[str]]
"""From what has been typed of a value, every value that begins so."""


def _tasks() -> Iterable[str]:
    return (*remac_env.tasks(clock="events"), GENERATED.name)


def _styles() -> Iterable[str]:
    from remac_env.kitchen import style

    return style.names()


def _layouts() -> Iterable[str]:
    from remac_env.kitchen import layout

    return layout.names(*layout.FAMILIES)


def _bodies() -> Iterable[str]:
    from remac_env.robots import bodies

    return bodies.every_name()


def _filling(role: str) -> Iterable[str]:
    return remac_agents.roles()[role]


NAMES: dict[str, Callable[[], Iterable[str]]] = {
    "task": _tasks,
    "tasks": _tasks,
    "methods": remac_agents.methods,
    "suite": suites.names,
    "style": _styles,
    "layout": _layouts,
    "body": _bodies,
    "held_out": lambda: (*_layouts(), *_styles()),
    "skills": lambda: (SCRIPTED, LEARNED),
    "learn.skills": skills,
    "roles": remac_agents.roles,
    **{role: partial(_filling, role) for role in ROLES},
}
"""Keyword of an option, with its command where it means something else there -> the names that it takes."""


def completer(home: str, keyword: str, values: Values) -> Complete | None:
    """What completes the values of an option; None for numbers, files and texts."""
    names = NAMES.get(f"{home}.{keyword}", NAMES.get(keyword))
    if isinstance(values, Choice | Names):
        names = lambda: [str(name) for name in values.names if name is not None]
    if names is None:
        return None
    return lambda incomplete: _beginning(incomplete, names(), several=values.many or isinstance(values, Names))


def _beginning(incomplete: str, names: Iterable[str], *, several: bool) -> list[str]:
    """The names that begin so; of several with commas between them, the last one is completed."""
    before, comma, last = incomplete.rpartition(",") if several else ("", "", incomplete)
    given = before.split(",")
    return [f"{before}{comma}{name}" for name in names if name.startswith(last) and name not in given]
