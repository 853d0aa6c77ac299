"""What the tests of knowledge share: kitchens that tell all they can, and all that is given in them."""

from __future__ import annotations

from typing import Any

import remac_env
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.tasks.spec import TaskSpec

TRUTH = ("world", "goal_test")
"""What infos hold for those that are given the truth; the digest of a start names it for who has it already."""


def kitchen(spec: TaskSpec, **options: Any) -> KitchenParallelEnv:
    """All that can be told is told."""
    return remac_env.parallel_env(spec, backend="symbolic", feedback="reason", text="states", **options)


def given(env: KitchenParallelEnv, seen: Any, infos: Any, *more: Any) -> list[Any]:
    """All that a planner or learner may go by: every value, and every order of names."""
    told: list[Any] = [repr(env), str(env), *more]
    for robot, info in infos.items():
        known = {key: value for key, value in info.items() if key not in TRUTH}
        known["episode"] = {key: value for key, value in info["episode"].items() if key != "digest"}
        told += [(key, repr(value)) for key, value in known.items()]
        told += [(key, part.tolist()) for key, part in seen[robot].items()] if robot in seen else []
        told += [env.action_mask(robot).tolist()]
    return [*told, env.state().tolist()]
