"""Names of the environments, and entering them with robosuite."""

from __future__ import annotations

from typing import Any

from robosuite.environments.base import REGISTERED_ENVS

from remac_env.integrations.robosuite.env import RemacKitchen
from remac_env.tasks import get, names


def environment_name(task: str) -> str:
    """What `robosuite.make` calls a task."""
    return f"RemacKitchen{task}"


def register_tasks() -> list[str]:
    """Enter every task that robosuite does not know yet; returns the names of all of them for `robosuite.make`.

    To be called again after `remac_env.register_task`.
    """
    for task in names():
        name = environment_name(task)
        if name not in REGISTERED_ENVS:
            # robosuite enters classes when they are made, by their name.
            meta: Any = type(RemacKitchen)
            meta(name, (RemacKitchen,), {"SPEC": get(task), "__doc__": RemacKitchen.__doc__, "__module__": __name__})
    return [environment_name(task) for task in names()]
