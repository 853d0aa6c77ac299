"""The book of a running episode: checks, steps and plans. It keeps score with the truth; no role reads it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from remac_agents.plan import Plan
from remac_agents.report import Check, Step
from remac_env.rules.facts import Rules
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import WorldState


@dataclass
class Ledger:
    """What was planned, run and found so far."""

    initial: Plan = field(default_factory=lambda: Plan.of({}))
    finished: list[dict[str, Subtask]] = field(default_factory=list)
    finished_done: list[bool] = field(default_factory=list)
    steps: list[Step] = field(default_factory=list)
    pre_checks: list[Check] = field(default_factory=list)
    post_checks: list[Check] = field(default_factory=list)
    reflections: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    adjusted: bool = False
    current_done: dict[str, bool] = field(default_factory=dict)

    def score(
        self, robot: str, subtask: Subtask, *, status: str | None, done: bool | None, round_: int
    ) -> None:
        """Note a step that was run, as a try at the round at hand."""
        retry = robot in self.current_done
        self.current_done[robot] = bool(done)
        self.steps.append(Step(round_, robot, subtask.text, status, done, retry))

    def close_round(self, played: Mapping[str, Subtask]) -> None:
        """The plan goes on: what was played belongs to the plan in force."""
        self.finished.append(dict(played))
        self.finished_done.append(self._round_done(played))
        self.current_done = {}

    def close_step(self, robot: str, subtask: Subtask) -> None:
        """The same for one robot by itself: its steps in a row stand beside the other robots', as in rounds."""
        done = self.current_done.pop(robot, False)
        if subtask == WAIT:
            return
        index = max((i + 1 for i, played in enumerate(self.finished) if robot in played), default=0)
        if index == len(self.finished):
            self.finished.append({})
            self.finished_done.append(True)
        self.finished[index][robot] = subtask
        self.finished_done[index] &= done

    def executed(self) -> dict[str, tuple[str, ...]]:
        """Robot -> commands run so far, retries included."""
        names = dict.fromkeys(step.robot for step in self.steps)
        return {name: tuple(step.subtask for step in self.steps if step.robot == name) for name in names}

    def plan_in_force(self, remaining: Plan) -> Plan:
        """The rounds played, each once, and those that remain."""
        names = dict.fromkeys([*(name for played in self.finished for name in played), *remaining.robots])
        rows = {
            name: [played.get(name, WAIT) for played in self.finished] + list(remaining.row(name))
            for name in names
        }
        return Plan.of(rows)

    def rounds_done(self, remaining: Plan) -> int:
        """Rounds of the plan in force that are done, the one at hand included."""
        here = bool(self.current_done) and self._round_done(remaining.round()) if remaining.length else False
        return sum(self.finished_done) + here

    def _round_done(self, played: Mapping[str, Subtask]) -> bool:
        return all(
            self.current_done.get(robot, False) for robot, subtask in played.items() if subtask != WAIT
        )


def really_done(scene: Rules, before: WorldState, after: WorldState, robot: str, subtask: Subtask) -> bool:
    """Whether a subtask's post-conditions hold; one that needs something in hand is never done without it."""
    held = before.robots[robot].holding
    if subtask.row.puts and held is None:
        return False
    return all(condition.holds(scene, after) for condition in subtask.achieves(robot, held))
