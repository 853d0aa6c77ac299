"""Steps one after the other, as classical planners have them, in rounds: what can be done side by side is."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from remac_agents.plan import MAX_STEPS
from remac_env.events.rehearsal import rehearse
from remac_env.pddl import Step
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

Joint = dict[str, Subtask]


class StepError(Exception):
    """A step that this kitchen's rules do not carry out, and why."""


def in_rounds(rules: Rules, world: WorldState, steps: Sequence[Step]) -> list[Mapping[str, Subtask]]:
    """Rounds that come to the same as the steps in their order, by the skill table; a joint command each.

    A robot's own steps keep their order. One goes before steps of others that come earlier where that makes no
    difference. Who waits for something that takes its time waits as many rounds as that takes by the table's seconds.

    Raises:
        StepError: for a step that does not succeed, or waits for what does not come about.
    """
    left = list(steps)

    def choose(now: WorldState, going_on: Mapping[str, float]) -> Joint | None:
        if not left:
            return None
        waiting = {step for step in left if not all(each.over(now, going_on) for each in step.awaits)}
        joint, left[:] = _round(rules, now, left, waiting)
        if not joint:
            _check_goes_on(left[0], now, going_on)
        return dict.fromkeys(rules.robots, WAIT) | joint

    rounds = rehearse(rules, world, choose, rounds=MAX_STEPS)
    if left:
        raise StepError(f"{len(left)} of its steps do not begin within {MAX_STEPS} rounds")
    return rounds


def _check_goes_on(step: Step, now: WorldState, going_on: Mapping[str, float]) -> None:
    """Look whether what a step waits for is under way."""
    for each in step.awaits:
        if not each.over(now, going_on) and each.what not in going_on:
            told = f"waits for {each.process.name} of the {each.name}, which does not go on"
            raise StepError(f"its step {step.skill} {step.target} of {step.robot} {told}")


def _round(
    rules: Rules, world: WorldState, left: Sequence[Step], waiting: Collection[Step]
) -> tuple[Joint, list[Step]]:
    """As many of the steps that are left as go side by side, and those that stay; nothing where all robots wait."""
    joint, after, busy, stay = Joint(), world, set[str](), list[Step]()
    for step in left:
        found = None
        if step.robot not in busy and step not in waiting:
            found = _beside(rules, world, after, joint, step, stay) if joint or stay else _first(rules, world, step)
        busy.add(step.robot)
        if found is None:
            stay.append(step)
        else:
            joint[step.robot], after = found
    return joint, stay


def _first(rules: Rules, world: WorldState, step: Step) -> tuple[Subtask, WorldState]:
    """The command of the step that comes next, and the world after it."""
    command = _command(rules, world, step)
    after, problem = _played(rules, world, {step.robot: command})
    if after is None:
        raise StepError(f"its step {step.skill} {step.target} of {step.robot} does not succeed: {problem}")
    return command, after


def _beside(
    rules: Rules, world: WorldState, after: WorldState, joint: Joint, step: Step, stay: Sequence[Step]
) -> tuple[Subtask, WorldState] | None:
    """A step's command beside those of a round, and the world then; None where it makes a difference to do it now.

    Args:
        after: the world without it.
        stay: the steps before it that are not done in this round.
    """
    command = step.command(rules, world)
    if command is None:
        return None
    together, _ = _played(rules, world, {**joint, step.robot: command})
    if together is None or _sequence(rules, after, [*stay, step]) != _sequence(rules, together, stay):
        return None
    return command, together


def _sequence(rules: Rules, world: WorldState, steps: Sequence[Step]) -> WorldState | str:
    """The world after steps one by one; which of them fails, else."""
    for number, step in enumerate(steps):
        command = step.command(rules, world)
        after = None if command is None else _played(rules, world, {step.robot: command})[0]
        if after is None:
            return f"step {number} of {len(steps)} fails"
        world = after
    return world


def _command(rules: Rules, world: WorldState, step: Step) -> Subtask:
    command = step.command(rules, world) or step.in_its_stead(rules)
    if command is None:
        raise StepError(f"its step {step.skill} {step.target} of {step.robot}: no command of this kitchen does that")
    return command


def _played(rules: Rules, world: WorldState, joint: Joint) -> tuple[WorldState | None, str]:
    """The world after a round; None, and why, where one of its subtasks does not succeed."""
    after, outcomes = transition(rules, world, joint)
    failed = [outcome for outcome in outcomes.values() if not outcome.success]
    return (None, failed[0].detail or str(failed[0].reason)) if failed else (after, "")
