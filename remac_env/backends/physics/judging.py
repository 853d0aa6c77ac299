"""How a subtask has ended, by the world that is read at its end and told with it. Pure functions."""

from __future__ import annotations

from dataclasses import dataclass, replace

from remac_env.rules.claims import Claim
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState


@dataclass(frozen=True)
class Begun:
    """A subtask that a robot has begun: at which control step, in which world, what it claims, and what the skill table
    makes of that world (where things take their time; else the same)."""

    subtask: Subtask
    robot: str
    began: int
    world: WorldState
    claim: Claim
    after: WorldState

    def missing(self, rules: Rules, world: WorldState) -> list[Condition]:
        """What the subtask achieves and is not true in a world."""
        achieved = self.subtask.achieves(self.robot, self.world.robots[self.robot].holding)
        return [condition for condition in achieved if not condition.holds(rules, world)]


def judged(task: Begun, outcome: Outcome, rules: Rules, world: WorldState) -> Outcome:
    """An outcome by the world as it is now, whatever a controller says: who is told of it plans in that world.

    A controller may give up on the way home with the object in its hand; were it told as a failure, every other try
    would be refused, as the hand is full. A failed drive has failed, even close by: it can always be tried again. So
    has a hand that dropped something beside what another robot opened.
    """
    missing = task.missing(rules, world)
    if outcome.success:
        said = f"not true at rest: {missing[0].sentence}" if missing else ""
        return replace(outcome, status="failure", reason="slipped", detail=said) if missing else outcome
    if missing or task.subtask.moves or outcome.reason == "dropped" or not task.missing(rules, task.world):
        return outcome
    return replace(outcome, status="success", reason=None, detail="")
