"""What other installed packages add: names in the groups of entry points that are listed here.

    [project.entry-points."remac.tasks"]
    my_tasks = "my_package.tasks"              # a module that calls remac_env.register_task
    [project.entry-points."remac.planners"]
    mine = "my_package.planners:MyPlanner"     # also remac.checkers, remac.adjusters, ... : one group a role
Nothing is loaded before somebody asks for a name, or for all of them.
"""

from __future__ import annotations

from functools import lru_cache
from importlib import metadata

from remac_env.errors import OptionError

TASKS = "remac.tasks"


def group_of(role: str) -> str:
    """The group of a role's names: "remac.planners"."""
    return f"remac.{role.removesuffix('s')}s"


@lru_cache(maxsize=32)
def installed(group: str) -> dict[str, str]:
    """Name -> address ("module:attribute" or "module") of what installed packages add to a group, sorted by name."""
    found = metadata.entry_points(group=group)
    return {entry.name: entry.value for entry in sorted(found, key=lambda entry: (entry.name, entry.value))}


@lru_cache(maxsize=1)
def load_tasks() -> None:
    """Import, once, every module that registers tasks.

    Raises:
        OptionError: naming the entry point that cannot be imported.
    """
    for entry in sorted(metadata.entry_points(group=TASKS), key=lambda entry: entry.name):
        try:
            entry.load()
        except (ImportError, AttributeError, SyntaxError) as error:
            package = entry.dist.name if entry.dist is not None else "an installed package"
            raise OptionError(
                f"tasks {entry.name!r} of {package} cannot be imported from {entry.value!r}: {error}"
            ) from error
