"""Who takes in what happens in an episode, shows each role what it may see of it, and keeps score by the truth."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Literal

from remac_agents.report import Check
from remac_agents.roles import Checker, Verdict, View
from remac_agents.running.ledger import Ledger, really_done
from remac_agents.running.moments import Moment, ran_so_far, shown
from remac_env.rules.conditions import Condition
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState

When = Literal["before", "after"]


class Bookkeeper:
    """The moment at hand, those before it, and the ledger. No role is handed the book: `seen_by` says what it sees."""

    def __init__(self, view: View, world: WorldState | None, rules: Rules) -> None:
        """Start at a reset; `rules` and `world` are handed only to roles that need them, and to the ledger."""
        self.view, self._world, self.rules = view, world, rules
        self.ledger = Ledger()
        self.moments: list[Moment] = []
        self.steps = 0
        """Steps of the kitchen so far; with the event clock some pass without a moment, as nobody decides in them."""
        self._began: dict[str, WorldState | None] = {}
        self._verdicts: dict[Condition, Verdict] = {}
        self._noted: set[tuple[When, str, str, Condition]] = set()

    @property
    def rounds(self) -> int:
        """How many were played."""
        return len(self.moments)

    def seen_by(self, role: object) -> View:
        """The present moment as this role may see it."""
        return shown(self.view, self.rules, self._world, role)

    def seen_at(self, moment: Moment, when: When, role: object) -> View:
        """What this role may see of the moment before or after a round that was played."""
        if when == "before":
            return shown(moment.before, self.rules, moment.world_before, role)
        return shown(moment.after, self.rules, moment.world_after, role)

    def begin(self, robots: Collection[str]) -> None:
        """These robots begin something now."""
        self._began |= dict.fromkeys(robots, self._world)

    def observe(
        self, view: View, world: WorldState | None, played: Mapping[str, Subtask], *, robots: Collection[str]
    ) -> None:
        """Take in the moment after a round, and score by the truth what these robots played."""
        for robot, subtask in played.items():
            if subtask == WAIT or robot not in robots:
                continue
            report = view.reports.get(robot)
            done, began = None, self._began.pop(robot, self._world)
            if began is not None and world is not None:
                done = really_done(self.rules, began, world, robot, subtask)
            status = None if report is None else report.status
            self.ledger.score(robot, subtask, status=status, done=done, round_=self.rounds)
        self.moments.append(Moment(self.rounds, dict(played), self.view, view, self._world, world))
        self.view, self._world = view, world
        self._verdicts.clear()
        self._noted.clear()

    def judge(self, checker: Checker, robot: str, conditions: Sequence[Condition]) -> dict[Condition, Verdict]:
        """Verdicts, None where the checker gives none; a question put twice at one moment is answered once."""
        fresh = [condition for condition in dict.fromkeys(conditions) if condition not in self._verdicts]
        if fresh:
            self._verdicts |= {condition: Verdict(condition, None, "not judged") for condition in fresh}
            moment = replace(self.seen_by(checker), robot=robot, ran=ran_so_far(self.moments))
            for verdict in checker.check(fresh, moment):
                self._verdicts[verdict.condition] = verdict
        return {condition: self._verdicts[condition] for condition in conditions}

    def note(
        self,
        when: When,
        robot: str,
        subtask: Subtask,
        verdicts: Mapping[Condition, Verdict],
        *,
        asked: bool = False,
    ) -> None:
        """Write verdicts about this moment down beside the truth, each once: checks before or after a subtask."""
        book = self.ledger.pre_checks if when == "before" else self.ledger.post_checks
        for condition, verdict in verdicts.items():
            key = (when, robot, subtask.text, condition)
            if key not in self._noted:
                self._noted.add(key)
                book.append(Check.of(verdict, self.steps, robot, subtask, self.rules, self._world, asked=asked))
