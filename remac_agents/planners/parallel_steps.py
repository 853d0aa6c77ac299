"""Steps one after the other, as classical planners have them, in rounds: what can be done side by side is."""

from __future__ import annotations

from collections.abc import Sequence

from remac_env.pddl import Step
from remac_env.rules.facts import Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

Joint = dict[str, Subtask]


class StepError(Exception):
    """A step that this kitchen's rules do not carry out, and why."""


def in_rounds(rules: Rules, world: WorldState, steps: Sequence[Step]) -> list[Joint]:
    """Rounds that come to the same as the steps in their order, by the skill table; a joint command each.

    A robot's own steps keep their order. One goes before steps of others that come earlier where that makes no
    difference.

    Raises:
        StepError: for a step that does not succeed.
    """
    left, rounds = list(steps), list[Joint]()
    while left:
        joint, left, world = _round(rules, world, left)
        rounds.append(dict.fromkeys(rules.robots, WAIT) | joint)
    return rounds


def _round(rules: Rules, world: WorldState, left: list[Step]) -> tuple[Joint, list[Step], WorldState]:
    """As many of the steps that are left as go side by side, those that stay, and the world after the round."""
    first = left[0]
    joint = {first.robot: _command(rules, world, first)}
    after, problem = _played(rules, world, joint)
    if after is None:
        raise StepError(f"its step {first.skill} {first.target} of {first.robot} does not succeed: {problem}")
    busy, stay = {first.robot}, list[Step]()
    for step in left[1:]:
        found = None
        if step.robot not in busy:
            busy.add(step.robot)
            found = _beside(rules, world, after, joint, step, stay)
        if found is None:
            stay.append(step)
        else:
            joint[step.robot], after = found
    return joint, stay, after


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
