"""An episode that is over as a summariser is told of it: the steps that were seen, and why it failed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from remac_agents.roles.requests import View
from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import Subtask


@dataclass(frozen=True)
class SeenStep:
    """A `subtask` that `robot` ran in a `round` (from 0), between what was seen just `before` and just `after` it."""

    round: int
    robot: str
    subtask: Subtask
    before: View
    after: View


@dataclass(frozen=True)
class Summary:
    """An episode in words: `events`, a line a step, and `subgoals`, a line a subgoal (the last try of each step)."""

    events: tuple[str, ...]
    subgoals: tuple[str, ...]


@dataclass(frozen=True)
class ExplainRequest:
    """An episode that failed.

    Attributes:
        goal: the sentence.
        summary: the episode in words.
        steps: the last try of each step, in order; `summary.subgoals` has one line for each.
        reached: whether the checker found each subgoal met; None where it cannot tell.
        false_before: index of a step -> its pre-conditions that the checker finds false, seen at that moment.
        plan: robot -> commands of the plan that failed.
    """

    goal: str
    summary: Summary
    steps: tuple[SeenStep, ...]
    reached: tuple[bool | None, ...]
    false_before: Callable[[int], tuple[Condition, ...]]
    plan: dict[str, tuple[str, ...]]


@dataclass(frozen=True)
class Explanation:
    """Why an episode failed: the `reason`, in words; `step`, the index of the step at fault, None where no step was;
    `false`, which of its conditions were."""

    reason: str
    step: int | None = None
    false: tuple[Condition, ...] = ()


def last_tries(steps: Sequence[SeenStep]) -> list[int]:
    """Indices of the steps that are not followed by another try of the same by the same robot."""
    found = []
    for index, step in enumerate(steps):
        later = next((other for other in steps[index + 1 :] if other.robot == step.robot), None)
        if later is None or later.subtask != step.subtask:
            found.append(index)
    return found
