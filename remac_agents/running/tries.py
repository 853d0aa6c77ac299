"""A try that reached the goal, kept so that it can be played again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from remac_agents.plan import Commands, Plan
from remac_agents.running.ledger import Ledger
from remac_env.rules.subtasks import WAIT, Subtask


@dataclass(frozen=True)
class Try:
    """An episode of an agent, as it was played.

    Attributes:
        initial: the first plan.
        rounds: what its robots did, round after round.
        rest: what the plan in force still had left when the goal was reached.
        retries: indices of the rounds that were further tries of the round before.
        adjusted: whether the plan was changed on the way.
    """

    initial: Plan
    rounds: tuple[Mapping[str, Subtask], ...]
    rest: Plan
    retries: frozenset[int]
    adjusted: bool

    @classmethod
    def of(cls, ledger: Ledger, plan: Plan, commands: Commands) -> Try:
        """The try that this book tells of; `plan` begins with the round that was played last."""
        count = max((step.round + 1 for step in ledger.steps), default=0)
        rounds: list[dict[str, Subtask]] = [{} for _ in range(count)]
        for step in ledger.steps:
            rounds[step.round][step.robot] = commands[step.subtask]
        retries = frozenset(step.round for step in ledger.steps if step.retry)
        return cls(ledger.initial, tuple(rounds), plan.rest(), retries, ledger.adjusted)

    @property
    def plan(self) -> Plan:
        """Every round that was played, and the rest."""
        names = dict.fromkeys([*(name for played in self.rounds for name in played), *self.rest.robots])
        played = {name: [turn.get(name, WAIT) for turn in self.rounds] for name in names}
        return Plan.of({name: [*row, *self.rest.row(name)] for name, row in played.items()})
