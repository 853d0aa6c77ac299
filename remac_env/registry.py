"""Names and makers of environments. Importing this loads neither a simulator nor Gymnasium."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from remac_env.gymnasium_ids import enter_ids
from remac_env.tasks import add, get, names
from remac_env.tasks.spec import TaskSpec

if TYPE_CHECKING:
    from remac_env.aec import KitchenAECEnv
    from remac_env.parallel import KitchenParallelEnv


def tasks() -> list[str]:
    """The names of all tasks."""
    return list(names())


def register_task(spec: TaskSpec) -> None:
    """Add a task from outside, and its Gymnasium id.

    Raises:
        OptionError: if the name is taken, or the task's parts do not fit together.
        UnknownNameError: for a role, fixture, style, layout or command in it that does not exist.
        KitchenFileError: for a malformed layout file or category.
    """
    from remac_env.validate import validate

    validate(spec)
    add(spec)
    enter_ids(names)


def parallel_env(
    task: str,
    robots: int = 2,
    backend: str = "physics",
    style: str | None = None,
    layout: str | None = None,
    starts: str = "paper",
    obs: str = "state",
    text: str = "plain",
    feedback: str = "status",
    wording: int = 3,
    naming: str = "role",
    perception_noise: float = 0.0,
    image_size: int = 128,
    render_mode: str | None = None,
    max_rounds: int = 30,
    reward: str = "sparse",
    failure_rate: float = 0.0,
) -> KitchenParallelEnv:
    """A task as a PettingZoo ParallelEnv. Everything is checked before anything is built.

    Args:
        task: one of `tasks()`.
        robots: 1 or 2; they are called robot_0 and robot_1.
        backend: "physics" (MuJoCo decides) or "symbolic" (the skill table, pure Python).
        style, layout: names, or None: the seed picks from the task's table.
        starts: "paper" (doors closed, all off) or "mixed".
        obs: "state" or "state+images" (front, wrist, side).
        text: "plain" (names only) or "states".
        feedback: what planners are told of a failure: "status" or "reason".
        wording: of the goal sentence, 1, 2 or 3, the simplest.
        naming: what things are called that play a role: "role" ("vegetable") or "category" ("carrot"). The goal
            sentence always has the role's noun: with "category", the planner must see that a carrot is a vegetable.
        perception_noise: standard deviation of the error in the poses that controllers in physics see, m, 0..0.1.
        image_size: of the observed images, pixels, 16..1024.
        render_mode: None, "rgb_array" or "human".
        max_rounds: rounds after which the episode is truncated.
        reward: "sparse" (1 on success) or "progress" (change of goal progress).
        failure_rate: 0..1, probability that a subtask slips in the symbolic backend.

    Raises:
        UnknownNameError: for an unknown task, style, layout or option value; lists the valid ones.
        OptionError: for a number outside its range.
    """
    given = dict(locals())
    from remac_env.options import Options
    from remac_env.parallel import KitchenParallelEnv

    return KitchenParallelEnv(get(given.pop("task")), Options(**given))


def env(task: str, robots: int = 2, **options: Any) -> KitchenAECEnv:
    """The same as a PettingZoo AEC environment; keywords as for `parallel_env`."""
    from remac_env.aec import KitchenAECEnv

    return KitchenAECEnv(parallel_env(task, robots, **options))


enter_ids(names)
