"""Makes the animation of docs/time.md: one robot cooks while the other fetches, under the event clock.

    python docs/make_cooking.py [--to FILE.webp] [--task TASK] [--seed N] [--layout NAME] [--style NAME]

The task's plan of `benchmarks/timed_plans.toml` is played in physics, and drawn as `make_animation.py` does.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from make_animation import make

from remac_env.rendering.renderer import VIDEO

FILE = Path(__file__).parent / "pictures" / "cooking.webp"
PLANS = Path(__file__).parent.parent / "benchmarks" / "timed_plans.toml"
SIZE = (480, 270)
"""Width and height, pixels."""


def main() -> None:
    """Play, draw and write the animation."""
    kitchen = {"task": "HeatAndShelve", "seed": 1, "layout": "one_wall_large"}
    make(cooked, __doc__, clock="events", size=SIZE, quality=VIDEO, to=FILE, **kitchen)


def cooked(env: Any, task: str, seed: int) -> None:
    """The plan of a timed task, each robot's commands as soon as what they wait for is over."""
    plan = {robot: [" ".join(part.split()) for part in text.split(";")]
            for robot, text in tomllib.loads(PLANS.read_text("utf-8"))[task].items()}
    _, infos = env.reset(seed=seed)
    while env.agents:
        over = {s.what if s.kind == "subtask" else f"{s.what} {s.who}" for s in env.timeline if s.status == "success"}
        tokens = {}
        for robot, left in plan.items():
            while left and left[0].startswith("until ") and left[0].removeprefix("until ") in over:
                del left[0]
            command = "wait" if not left or left[0].startswith("until ") else left[0]
            if not infos[robot]["ready"]:
                command = "continue"
            elif command != "wait":
                del left[0]
            tokens[robot] = env.vocabulary.encode(command)
        _, _, _, _, infos = env.step(tokens)
    if not all(info["success"] for info in infos.values()):
        raise SystemExit(f"{task} with seed {seed} was not done")


if __name__ == "__main__":
    main()
