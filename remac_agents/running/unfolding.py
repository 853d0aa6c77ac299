"""A plan carried out by the event clock: each robot goes on when what comes before its next step has ended.

The checks are those of rounds, robot by robot; what a helper has prepared is an event, and nobody waits for a round.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from remac_agents.plan import Plan
from remac_agents.planning.order import NEW, Item, in_order
from remac_agents.roles import View
from remac_agents.running.checks import adjust, check_before, found_false_after
from remac_agents.running.method_run import MethodRun, Turns
from remac_agents.running.round_state import RoundState
from remac_agents.running.started import Started
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.thinking import NO_THOUGHT


def unfolded(run: MethodRun) -> Turns:
    """The loop of checks around a plan, where robots do not wait for each other."""
    course = Unfolding(run)
    while not course.over:
        yield course.begin()
        course.note_outcomes()


@dataclass(frozen=True, kw_only=True)
class _SideBySide(RoundState):
    """The next step of every robot. Those that are at work or may not begin yet are not `pending`."""

    @property
    def through(self) -> dict[str, Subtask]:
        return {}

    def with_row(self, robot: str, row: Sequence[Subtask]) -> RoundState:
        return replace(self, plan=Plan.of({**self.plan.rows, robot: row}))


@dataclass(frozen=True)
class _Begun:
    """A step under way, and what its conditions saw when it began."""

    item: Item
    before: View


class Unfolding:
    """How far the plan in force has come: what each robot still has to do, what it is at, and what has ended."""

    def __init__(self, run: MethodRun) -> None:
        self._run = run
        self._rows = {robot: list(row) for robot, row in in_order(run.plan, run.book.view.scene).items()}
        self._left = dict.fromkeys(self._rows, run.bounds.rounds)
        self._at: dict[str, _Begun] = {}
        self._tries: dict[str, int] = {}
        self._held_up: set[str] = set()
        self._waiting: dict[str, tuple[int, float]] = {}
        self._started = {robot: Started() for robot in self._rows}
        self._show(())

    @property
    def over(self) -> bool:
        """Whether nothing is left and nobody is at anything, or no robot may begin anything more."""
        return not self._at and not any(row and self._left[robot] for robot, row in self._rows.items())

    def begin(self) -> dict[str, Subtask]:
        """What the robots begin that are ready and may go on; the others wait."""
        run = self._run
        for started in self._started.values():
            started.look(run.book.view.slow, self._now)
        able = self._able()
        self._show(able)
        while able and (failed := check_before(run)):
            adjust(run, failed)
            self._follow(run.plan)
            able = self._able()
            self._show(able)
        for robot, item in able.items():
            self._at[robot] = _Begun(item, run.book.seen_by(run.roles.conditions))
            self._left[robot] -= 1
        idle = [robot for robot in run.ready if robot in self._rows and robot not in able]
        run.thoughts |= dict.fromkeys(idle, NO_THOUGHT)
        return {**dict.fromkeys(idle, WAIT), **{robot: item.step for robot, item in able.items()}}

    def note_outcomes(self) -> None:
        """Check what has ended; a step whose post-conditions are found false is tried again, as with rounds."""
        run = self._run
        ended = {robot: begun for robot, begun in self._at.items() if robot in run.ready}
        for robot, begun in ended.items():
            del self._at[robot]
            step = begun.item.step
            slipped = found_false_after(run, robot, step, begun.before)
            if not slipped:
                self._started[robot].ended(step, self._now)
            others = run.state.slipped - {robot}
            run.state = replace(run.state, slipped=others | {robot} if slipped else others)
            if slipped and self._again(robot, step):
                continue
            self._tries.pop(robot, None)
            self._rows[robot].pop(0)
            run.book.ledger.close_step(robot, step)
        if ended:
            self._held_up -= {robot for robot in self._held_up if ended.keys() - {robot}}
        self._show(())

    def _again(self, robot: str, step: Subtask) -> bool:
        """Whether it is tried again. A drive in whose way somebody may be waits for that one, and does not count."""
        if step.moves and self._at:
            self._held_up.add(robot)
            return True
        self._tries[robot] = self._tries.get(robot, 0) + 1
        return self._tries[robot] <= self._run.bounds.retries

    # -- what may begin ---------------------------------------------------------------------------------------------

    def _able(self) -> dict[str, Item]:
        """The next steps of robots that are ready, for which nothing has to be waited."""
        ready = [robot for robot in self._run.ready if robot not in self._at and self._left.get(robot, 0)]
        for robot in ready:
            self._pass_waits(robot)
        rows, open_ = self._rows, self._open
        heads = {robot: rows[robot][0] for robot in ready if rows[robot] and rows[robot][0].is_step}
        slow = [robot for robot, item in heads.items() if self._started[robot].ends(item.step)]
        heads = {robot: item for robot, item in heads.items() if robot not in slow}
        held_up = self._held_up if self._at else set()
        able = {robot: item for robot, item in heads.items() if not item.after & open_ and robot not in held_up}
        while True:
            numbers = {item.number for item in able.values()}
            alone = [robot for robot, item in able.items() if (item.beside & open_) - numbers]
            if not alone:
                break
            for robot in alone:
                del able[robot]
        waits = slow or any(row and not row[0].is_step for row in rows.values())
        if heads and not able and not self._at and not waits:  # each waits for another one: the first in the plan goes
            first = min(heads, key=lambda robot: heads[robot].number)
            return {first: heads[first]}
        return able

    @property
    def _now(self) -> float:
        return self._run.book.view.clock or 0.0

    @property
    def _open(self) -> set[int]:
        """The steps that have not ended."""
        return {item.number for row in self._rows.values() for item in row}

    def _pass_waits(self, robot: str) -> None:
        """Leave waits behind that are over: they began at an earlier decision point, and have lasted long enough."""
        row, now, open_ = self._rows[robot], self._now, self._open
        while row and not row[0].is_step:
            item = row[0]
            if self._started[robot].over:
                row.pop(0)
                continue
            if self._waiting.get(robot, (-1, now))[0] != item.number and (item.seconds or not item.after & open_):
                self._waiting[robot] = (item.number, now)
            number, since = self._waiting.get(robot, (-1, now))
            if number != item.number or item.after & open_ or since >= now or now - since < item.seconds:
                return
            row.pop(0)

    # -- the plan in force ------------------------------------------------------------------------------------------

    def _show(self, able: Mapping[str, Item] | tuple[()]) -> None:
        """Let the run's plan be what is left, the steps under way first; those that may begin are at their turn."""
        rows = {robot: [item.step for item in row if item.is_step] for robot, row in self._rows.items()}
        state = self._run.state
        self._run.state = _SideBySide(
            plan=Plan.of(rows), pending=frozenset(able), tries=0, accepted=state.accepted, slipped=state.slipped,
            adjustments=state.adjustments,
        )  # fmt: skip

    def _follow(self, plan: Plan) -> None:
        """Take over rows that were changed: what is old at their ends keeps its order, what is new has none."""
        for robot, old in self._rows.items():
            new = plan.row(robot)
            steps = [item for item in old if item.is_step]
            if tuple(item.step for item in steps) == new:
                continue
            kept = 0
            while kept < min(len(steps), len(new)) and steps[-1 - kept].step == new[-1 - kept]:
                kept += 1
            first = steps[len(steps) - kept] if kept else None
            tail = old[old.index(first) :] if first is not None else []
            self._rows[robot] = [*(Item(number=NEW, step=step) for step in new[: len(new) - kept]), *tail]
