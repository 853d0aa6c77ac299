"""Names and makers of environments. Importing this loads no simulator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium

from remac_env.tasks import add, get, names
from remac_env.tasks.spec import TaskSpec

if TYPE_CHECKING:
    from pettingzoo import AECEnv

    from remac_env.parallel import KitchenParallelEnv


def tasks() -> list[str]:
    """The names of all tasks."""
    return list(names())


def register_task(spec: TaskSpec) -> None:
    """Add a task from outside, and its Gymnasium id.

    Raises:
        OptionError: if the name is taken or not CamelCase.
    """
    add(spec)
    _register_gymnasium(spec.name)


def parallel_env(task: str, **options: Any) -> KitchenParallelEnv:
    """A task as a PettingZoo ParallelEnv.

    Args:
        task: one of `tasks()`.
        options: keywords, each checked before anything is built:
            robots: 1 or 2 (default 2); they are called robot_0 and robot_1.
            backend: "physics" (default; MuJoCo decides) or "symbolic" (the skill table, pure Python).
            style, layout: names, or None: the seed picks from the task's table.
            starts: "paper" (doors closed, all off, default) or "mixed".
            obs: "state" (default) or "state+images" (front, wrist, side; image_size pixels, default 128).
            text: "plain" (names only, default) or "states".
            feedback: what planners are told of a failure: "status" (default) or "reason".
            wording: 1, 2 or 3 (default 3, the simplest goal sentence).
            naming: "role".
            perception_noise: m, disturbs the poses that controllers in physics see (default 0).
            failure_rate: 0..1, probability that a subtask slips in the symbolic backend (default 0).
            render_mode: None, "rgb_array" or "human".
            max_rounds: rounds after which the episode is truncated (default 30).
            reward: "sparse" (1 on success, default) or "progress" (change of goal progress).

    Raises:
        UnknownNameError: for an unknown task, style, layout or option value; lists the valid ones.
        OptionError: for a number outside its range.
        TypeError: for an unknown keyword.
    """
    from remac_env.options import Options
    from remac_env.parallel import KitchenParallelEnv

    return KitchenParallelEnv(get(task), Options(**options))


def env(task: str, **options: Any) -> AECEnv[str, Any, Any]:
    """The same as a PettingZoo AEC environment; options as for `parallel_env`."""
    from pettingzoo.utils import parallel_to_aec

    return parallel_to_aec(parallel_env(task, **options))


def _register_gymnasium(task: str) -> None:
    name = f"RemacKitchen-{task}-v0"
    if name not in gymnasium.registry:
        # The kitchen checks its own order of calls and never returns a time limit of Gymnasium's.
        gymnasium.register(id=name, entry_point="remac_env.gym_view:KitchenEnv", kwargs={"task": task})


for _name in names():
    _register_gymnasium(_name)
