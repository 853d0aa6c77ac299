"""A plan in PDDL's terms carried out in a kitchen under the event clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from remac_env.pddl.plans import Step

NEAR = 0.05
"""s by which a planner's times may be apart that mean the same: planners part what follows by a thousandth."""


@dataclass(frozen=True)
class Played:
    """How a plan went. `seconds`: on the clock at the end; `failed`: commands that did not succeed, with the reason."""

    success: bool
    seconds: float
    failed: tuple[str, ...]


def play_plan(env: Any, plan: Sequence[Step], *, seed: int) -> Played:
    """Reset a kitchen (`clock="events"`) and carry a plan out.

    Each robot takes its steps in order. A step begins once all has ended that ends before it by the plan, so that it
    may begin sooner or later than the plan says.
    """
    _, infos = env.reset(seed=seed)
    left, over = list(plan), set[int]()
    at: dict[str, tuple[int, str]] = {}
    failed: list[str] = []
    while env.agents:
        for robot, info in infos.items():
            if info["outcome"] and robot in at:
                number, text = at.pop(robot)
                over.add(number)
                failed += [f"{text}: {info['outcome']['reason']}"] if info["outcome"]["reason"] else []
        if not left and not at and not any(info["processes"] for info in infos.values()):
            break
        tokens = {robot: info["continue"] for robot, info in infos.items()}
        for robot in [robot for robot, info in infos.items() if info["ready"]]:
            number, step = next(((n, s) for n, s in enumerate(plan) if s in left and s.robot == robot), (-1, None))
            command = None
            if step is not None and all(n in over for n, s in enumerate(plan) if s.at + s.seconds <= step.at + NEAR):
                command = step.command(env.start.scene, env.world)
            if command is not None and step is not None:
                left.remove(step)
                at[robot] = (number, command.text)
            tokens[robot] = env.vocabulary.encode("wait" if command is None else command.text)
        _, _, _, _, infos = env.step(tokens)
    info = next(iter(infos.values()))
    return Played(bool(info["success"]), float(info["seconds"]), tuple(failed))
