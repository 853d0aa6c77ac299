"""How far a plan has come: what its robots still have to do of its first round, and with how many tries. A value."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from remac_agents.plan import Plan
from remac_env.rules.subtasks import WAIT, Subtask


@dataclass(frozen=True, kw_only=True)
class RoundState:
    """The plan from its first round on that is not behind it.

    Attributes:
        plan: what remains, the round at hand first.
        pending: robots that are not through with this round.
        tries: how often this round was tried.
        accepted: robots whose subtask is tried at this moment although a pre-condition of it was found false.
        slipped: robots whose last try was found not to have worked.
        adjustments: how often the adjuster was asked in this episode.
    """

    plan: Plan = field(default_factory=lambda: Plan.of({}))
    pending: frozenset[str] = frozenset()
    tries: int = 0
    accepted: frozenset[str] = frozenset()
    slipped: frozenset[str] = frozenset()
    adjustments: int = 0

    @property
    def turn(self) -> dict[str, Subtask]:
        """What the plan's robots do next; those that are through with this round wait."""
        return {robot: step if robot in self.pending else WAIT for robot, step in self.plan.round().items()}

    @property
    def through(self) -> dict[str, Subtask]:
        """What was done of this round already, by robots that are through with it."""
        return {r: step for r, step in self.plan.round().items() if r not in self.pending and step != WAIT}

    def opened(self, plan: Plan) -> RoundState:
        """At the start of this plan's first round."""
        return replace(self, plan=plan, pending=frozenset(plan.robots), tries=0)

    def at_next_moment(self) -> RoundState:
        """The same when a round was played: pre-conditions are looked at anew."""
        return replace(self, accepted=frozenset())

    def accepting(self, robot: str) -> RoundState:
        """The same with this robot's subtask to be tried as it is."""
        return replace(self, accepted=self.accepted | {robot})

    def tried(self, *, worked: Collection[str], slipped: Collection[str]) -> RoundState:
        """After a try of the round: the robots of which it worked are through; those that waited have not slipped."""
        acted = {robot for robot, step in self.turn.items() if step != WAIT}
        return replace(
            self,
            pending=self.pending - set(worked),
            tries=self.tries + 1,
            slipped=(self.slipped - (acted & set(worked))) | set(slipped),
        )

    def with_row(self, robot: str, row: Sequence[Subtask]) -> RoundState:
        """With a new row for one robot; what is `through` counts as a round of its own, behind this one."""
        done, plan = self.through, self.plan
        if done:
            plan = Plan.of({r: (WAIT, *old[1:]) if r in done else old for r, old in plan.rows.items()})
        return self.opened(plan.with_row(robot, row))

    def past_refused_drives(self) -> Plan | None:
        """The plan in which the other robots go on where only drives are still refused: they may be in the way.

        None where something else is refused, or nobody has anything to go on with.
        """
        refused = {robot for robot in self.pending if self.plan.round()[robot].skill == "navigate to"}
        rows = {robot: row if robot in refused else row[1:] for robot, row in self.plan.rows.items()}
        left = {step for robot, row in rows.items() if robot not in refused for step in row}
        return None if refused != self.pending or left <= {WAIT} else Plan.of(rows)
