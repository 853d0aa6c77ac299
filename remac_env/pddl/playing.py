"""A plan in PDDL's terms carried out in a kitchen under the event clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from remac_env.pddl.plans import NEAR, Step
from remac_env.rules.subtasks import WAIT
from remac_env.state import WorldState


@dataclass(frozen=True)
class Played:
    """How a plan went. `seconds`: on the clock at the end; `failed`: commands that did not succeed, with the reason."""

    success: bool
    seconds: float
    failed: tuple[str, ...]


def play_plan(env: Any, plan: Sequence[Step], *, seed: int) -> Played:
    """Reset a kitchen (`clock="events"`) and carry a plan out.

    Each robot takes its steps in order. A step begins once all has ended that ends before it by the plan, so that it
    may begin sooner or later than the plan says. Where nothing goes on, and no command leads to the station of the
    next drive, it is the drive to the fixture there (`Step.in_its_stead`); a step that no command does ends the plan.
    """
    _, infos = env.reset(seed=seed)
    left, over = set(range(len(plan))), set[int]()
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
        due = _due(plan, left, over, infos, env.world)
        rules = env.start.scene
        orders = {plan[n].robot: (n, plan[n].command(rules, env.world)) for n in due}
        goes_on = bool(at) or any(info["processes"] for info in infos.values())
        if due and not goes_on and all(command is None for _, command in orders.values()):
            orders = {plan[n].robot: (n, plan[n].in_its_stead(rules)) for n in due[:1]}
            if orders[plan[due[0]].robot][1] is None:
                failed.append(f"{plan[due[0]].skill} {plan[due[0]].target}: no command does that")
                break
        tokens = {robot: info["continue"] for robot, info in infos.items()}
        tokens |= {robot: env.vocabulary.encode(WAIT.text) for robot, info in infos.items() if info["ready"]}
        for robot, (number, command) in orders.items():
            if command is not None:
                left.discard(number)
                at[robot] = (number, command.text)
                tokens[robot] = env.vocabulary.encode(command.text)
        _, _, _, _, infos = env.step(tokens)
    info = next(iter(infos.values()))
    return Played(bool(info["success"]), float(info["seconds"]), tuple(failed))


def _due(
    plan: Sequence[Step], left: set[int], over: set[int], infos: Mapping[str, Any], world: WorldState
) -> list[int]:
    """The steps that may begin now: each ready robot's next one, where all has ended that ends before it."""
    ready = [robot for robot, info in infos.items() if info["ready"]]
    nexts = (next((n for n in sorted(left) if plan[n].robot == robot), None) for robot in ready)
    return [
        n
        for n in nexts
        if n is not None
        and all(each.over(world, infos[plan[n].robot]["processes"]) for each in plan[n].awaits)
        and all(m in over for m, s in enumerate(plan) if s.at + s.seconds <= plan[n].at + NEAR)
    ]
