"""Makes the animation of docs/time.md: one robot cooks while the other fetches, under the event clock.

    python docs/make_cooking.py [--to FILE.webp] [--task TASK] [--seed N] [--layout NAME] [--style NAME]

The task's plan of `benchmarks/timed_plans.toml` is played in physics, and drawn as `make_animation.py` does.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from event_turns import Infos, turns
from make_animation import make
from timed_plans import Agenda, plan_of

from remac_env.rendering.renderer import VIDEO

FILE = Path(__file__).parent / "pictures" / "cooking.webp"
SIZE = (480, 270)
"""Width and height, pixels."""
VIEW = (-0.38, -1.0, 0.42)
"""From the left, where the robot that fetches does not stand before the stove."""


def main() -> None:
    """Play, draw and write the animation."""
    kitchen = {"task": "HeatAndShelve", "seed": 1, "layout": "one_wall_large"}
    make(cooked, __doc__, clock="events", view=VIEW, size=SIZE, quality=VIDEO, to=FILE, **kitchen)


def cooked(env: Any, task: str, seed: int) -> None:
    """The plan of a timed task, each robot's commands as soon as what they wait for is over."""
    _, infos = env.reset(seed=seed)
    agenda = Agenda(plan_of(task, env.start, env.vocabulary))

    def choose(ready: Sequence[str], infos: Infos) -> dict[str, int]:
        able = agenda.able(ready, env.timeline)
        for robot in able:
            agenda.done(robot)
        return {robot: env.vocabulary.encode(step.subtask.text) for robot, step in able.items()}

    *_, infos = turns(env, infos, choose)
    if not all(info["success"] for info in infos.values()):
        raise SystemExit(f"{task} with seed {seed} was not done")


if __name__ == "__main__":
    main()
