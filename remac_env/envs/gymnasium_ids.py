"""Gymnasium's ids of the tasks and skills, entered without loading Gymnasium: that takes longest of all to load.

Where Gymnasium is loaded already, ids are entered at once; else as soon as somebody imports it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

from remac_env.lowlevel.names import skills

GYMNASIUM = "gymnasium"

LONGEST = 1200
"""Control periods, 60 s, after which the episode of a skill is cut off: as long as skills have in a round."""


Tasks = Callable[[], Mapping[str, Mapping[str, str]]]
"""Task -> options that it cannot be played without."""


def enter_ids(tasks: Tasks) -> None:
    """Register the id of each of `tasks()` that has none yet, now or when Gymnasium is first imported."""
    if GYMNASIUM in sys.modules:
        _register(tasks())
    elif not any(isinstance(finder, _Waiting) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Waiting(tasks))


def _register(tasks: Mapping[str, Mapping[str, str]]) -> None:
    import gymnasium

    for task, needed in tasks.items():
        name = f"RemacKitchen-{task}-v0"
        if name not in gymnasium.registry:
            # The kitchen checks its own order of calls and never returns a time limit of Gymnasium's.
            given = {"task": task, **needed}
            gymnasium.register(id=name, entry_point="remac_env.envs.gym_view:KitchenEnv", kwargs=given)
    for skill in skills():
        name = f"RemacSkill-{skill}-v0"
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name, entry_point="remac_env.lowlevel.env:SkillEnv", kwargs={"skill": skill},
                max_episode_steps=LONGEST,
            )  # fmt: skip


class _Waiting:
    """A finder that finds nothing itself, and has the ids entered behind the first import of Gymnasium."""

    def __init__(self, tasks: Tasks) -> None:
        self._tasks = tasks

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of Gymnasium as the other finders give it; None for every other module."""
        if fullname != GYMNASIUM:
            return None
        found = (finder.find_spec(fullname, path, target) for finder in sys.meta_path if finder is not self)
        spec = next((spec for spec in found if spec is not None), None)
        if spec is None or spec.loader is None:
            return spec
        loader, load = spec.loader, spec.loader.exec_module

        def load_and_register(module: ModuleType) -> None:
            loader.exec_module = load  # type: ignore[method-assign]
            load(module)
            # Not before: where the import failed, the next one is waited for.
            sys.meta_path.remove(self)
            _register(self._tasks())

        loader.exec_module = load_and_register  # type: ignore[method-assign]
        return spec
