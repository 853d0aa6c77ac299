"""What other installed packages add: names in the groups of entry points that are listed here.

    [project.entry-points."remac.tasks"]
    my_tasks = "my_package.tasks"              # a module that calls remac_env.register_task
    [project.entry-points."remac.planners"]
    mine = "my_package.planners:MyPlanner"     # also remac.checkers, remac.adjusters, ... : one group a role
Nothing is loaded before somebody asks for a name, or for all of them.
"""

from __future__ import annotations

import warnings
from functools import lru_cache
from importlib import metadata
from types import ModuleType

TASKS = "remac.tasks"

WORDS_MAX = 300
"""Characters of what a stranger's exception says."""


def group_of(role: str) -> str:
    """The group of a role's names: "remac.planners"."""
    return f"remac.{role.removesuffix('s')}s"


@lru_cache(maxsize=32)
def installed(group: str) -> dict[str, str]:
    """Name -> address ("module:attribute" or "module") of what installed packages add to a group, sorted by name."""
    found = metadata.entry_points(group=group)
    return {entry.name: entry.value for entry in sorted(found, key=lambda entry: (entry.name, entry.value))}


@lru_cache(maxsize=1)
def load_tasks() -> tuple[str, ...]:
    """Import, once, every module that registers tasks. One that cannot be imported spoils none of the others.

    Returns:
        What is wrong with those that add nothing, each with its entry point's name; a warning tells it too.
    """
    problems = []
    for entry in sorted(metadata.entry_points(group=TASKS), key=lambda entry: (entry.name, entry.value)):
        package = entry.dist.name if entry.dist is not None else "an installed package"
        who = f"tasks {entry.name!r} of {package}"
        try:
            found = entry.load()
        except (Exception, SystemExit) as error:  # noqa: BLE001 - a stranger's module may raise anything
            told = f"{type(error).__name__}: {_words(error)}"
            problems.append(f"{who} cannot be imported from {entry.value!r}: {told}")
            continue
        if not isinstance(found, ModuleType):
            problems.append(f"{who}: {entry.value!r} is no module (its type: {type(found).__name__})")
    if problems:
        warnings.warn("; ".join(problems), RuntimeWarning, stacklevel=3)
    return tuple(problems)


def _words(error: BaseException) -> str:
    try:
        return str(error)[:WORDS_MAX]
    except Exception:  # noqa: BLE001 - what a stranger's __str__ raises says nothing
        return "it does not say why"
