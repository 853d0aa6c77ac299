"""The symbolic backend: the skill table's effects in pure Python, no physics and no MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.base import (
    NOTHING_COUNTED,
    Counters,
    RoundResult,
    Start,
    check_all_idle,
    check_busy,
    check_idle,
)
from remac_env.errors import LifecycleError, OptionError
from remac_env.rules.claims import Claim, settle_claims
from remac_env.rules.facts import Process, Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.processes import outcome_of
from remac_env.rules.rounds import at_rest, attempts, carried, contradicted, merge
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.seeding import generator
from remac_env.state import WorldState

CLOCK_DIGITS = 6
"""Decimals of a second that the clock keeps, so that what should end together does."""

Seconds = Callable[[Subtask], float]
"""How long a subtask takes, s."""


def nominal(subtask: Subtask) -> float:
    """The seconds of the skill table: means that were seen in physics (benchmarks/skills.py)."""
    return SKILLS[subtask.skill].seconds


class _Running(NamedTuple):
    """A subtask under way: at which station and how it will end, and what that changes of the world."""

    subtask: Subtask
    station: str
    outcome: Outcome
    before: WorldState
    after: WorldState


Kept = tuple[WorldState, dict[str, _Running], float]
"""A moment: the world, what is under way, and the clock, s."""


class SymbolicBackend:
    """Rounds and events by the skill table alone. How a subtask ends is settled when it begins, from the world as it
    is then; its effect comes true when its nominal seconds are over.

    Args:
        failure_rate: probability in 0..1 that an accepted subtask other than `wait` and `done` slips and changes
            nothing, drawn from a generator of the episode.
        seconds: how long a subtask takes that is accepted now; those of the skill table by default.
    """

    def __init__(self, *, failure_rate: float = 0.0, seconds: Seconds = nominal) -> None:
        if not 0.0 <= failure_rate <= 1.0:
            raise OptionError(f"failure_rate {failure_rate!r} is not valid; valid: 0..1")
        self.watch: Callable[[], None] | None = None
        self.pictures: Callable[[str], Mapping[str, NDArray[np.uint8]]] | None = None
        self._failure_rate, self._seconds = failure_rate, seconds
        self._start: Start | None = None
        self._world: WorldState | None = None
        self._chance = np.random.default_rng(0)
        self._running: dict[str, _Running] = {}
        self._clock = 0.0

    def reset(self, start: Start) -> WorldState:
        """Take over the start's world."""
        self._start, self._world = start, start.world
        self._chance = generator(start.seed, "symbolic slips")
        self._running, self._clock = {}, 0.0
        return start.world

    def begin(self, subtasks: Mapping[str, Subtask]) -> dict[str, Outcome]:
        """Start subtasks of idle robots; the outcomes of those that are refused."""
        start, world = self._begun("begin")
        check_idle(subtasks, start.scene.robots, self._running)
        told, stations, results, _ = self._foretold(start.scene, world, subtasks)
        for robot, after in results.items():
            self._running[robot] = _Running(subtasks[robot], stations[robot], told.pop(robot), world, after)
        return told

    def advance(self, *, until: float = math.inf) -> dict[str, Outcome]:
        """Run until the next subtask ends; the outcomes of all that end then."""
        start, _ = self._begun("advance")
        ended = self._next(until)
        if ended:
            self._came_to_rest(start)
        return ended

    def stop(self, robot: str) -> None:
        """Tell a busy robot to stop.

        By half of its time a hand turns back, which takes as long as it took to come, and nothing has changed; later
        it goes through, as a drive does.
        """
        check_busy(robot, self._running)
        run, now = self._running[robot], self._clock
        spent = now - run.outcome.began
        if run.subtask.moves or run.outcome.reason == "interrupted" or 2 * spent >= run.outcome.seconds:
            return
        began, ended = run.outcome.began, round(now + spent, CLOCK_DIGITS)
        seconds = round(2 * spent, CLOCK_DIGITS)
        outcome = Outcome("failure", "interrupted", "it was told to stop", seconds, began=began, ended=ended)
        self._running[robot] = run._replace(outcome=outcome, after=run.before)

    def happen(self, process: Process, name: str) -> None:
        """Let what comes of a process come true."""
        start, world = self._begun("happen")
        self._world = outcome_of(world, process, name)
        self._came_to_rest(start)

    def go_on(self, processes: Mapping[tuple[Process, str], float]) -> None:
        """Nothing moves: it comes true when it happens."""

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """One round by the table; seconds are the table's nominal ones."""
        start, world = self._begun("run_round")
        check_all_idle(self._running)
        check_idle(subtasks, start.scene.robots, ())
        # What begins together and is alone comes true together, so that nothing has to be carried over one by one.
        told, _, _, self._world = self._foretold(start.scene, world, subtasks)
        seconds = max([outcome.seconds for outcome in told.values()], default=0.0)
        self._clock = max([outcome.ended for outcome in told.values()], default=self._clock)
        return RoundResult(self._came_to_rest(start), told, seconds)

    def kept(self) -> Kept:
        """The moment at hand, for `put_back`: what a search goes on from. Slips are not among it."""
        return self._begun("kept")[1], dict(self._running), self._clock

    @staticmethod
    def foreseen(world: WorldState, running: Mapping[str, _Running]) -> WorldState:
        """The world once all that is under way has come true."""
        for run in running.values():
            world = carried(run.before, run.after, world)
        return world

    def put_back(self, kept: Kept) -> None:
        """Go on from a moment of this episode that was kept."""
        self._world, self._clock = kept[0], kept[2]
        self._running = dict(kept[1])

    @property
    def world(self) -> WorldState:
        """The world after the last round, `begin` or `advance`."""
        return self._begun("world")[1]

    @property
    def settled(self) -> WorldState:
        """The same: what is under way comes true when it ends."""
        return self.world

    @property
    def busy(self) -> frozenset[str]:
        """The robots whose subtasks have begun and not ended."""
        return frozenset(self._running)

    @property
    def clock(self) -> float:
        """Simulated seconds since the start."""
        if self._start is None:
            self._begun("clock")
        return self._clock

    @property
    def counters(self) -> Counters:
        """Nothing is counted."""
        return NOTHING_COUNTED

    def positions(self) -> None:
        """Nothing is simulated."""

    def close(self) -> None:
        """Forget the episode."""
        self._start = self._world = None
        self._running = {}

    def _begun(self, what: str) -> tuple[Start, WorldState]:
        if self._start is None or self._world is None:
            raise LifecycleError(f"the symbolic backend needs reset(start) before {what}")
        return self._start, self._world

    def _foretold(
        self, scene: Rules, world: WorldState, subtasks: Mapping[str, Subtask]
    ) -> tuple[dict[str, Outcome], Mapping[str, str], dict[str, WorldState], WorldState]:
        """How subtasks will end that begin now: outcomes, stations, the world after each accepted one alone, and the
        world after all of them and those under way.
        """
        running = self._running
        claims = {r: Claim.of(scene, run.before, r, run.subtask, run.station) for r, run in running.items()}
        refused, stations = settle_claims(scene, world, subtasks, claims)
        accepted, slipped = subtasks, self._slips(subtasks, refused)
        if slipped:
            accepted = {robot: WAIT if robot in slipped else subtask for robot, subtask in subtasks.items()}
            refused, stations = settle_claims(scene, world, accepted, claims)
        if refused:
            accepted = {robot: subtask for robot, subtask in accepted.items() if robot not in refused}
        outcomes, results = attempts(scene, world, accepted, stations)
        every = results
        if running:
            every = {robot: carried(run.before, run.after, world) for robot, run in running.items()} | results
        merged = merge(world, every)
        if merged is None:
            outcomes, results, merged = contradicted(results), dict.fromkeys(results, world), world
        outcomes |= refused
        for robot in slipped:
            outcomes[robot] = failure("slipped", "a seeded slip")
        told = {robot: self._timed(outcome, subtasks[robot]) for robot, outcome in outcomes.items()}
        return told, stations, results, merged

    def _next(self, until: float = math.inf) -> dict[str, Outcome]:
        """Let the subtasks end whose time is over first; water has not run yet."""
        running, world, first = self._running, self._world, math.inf
        for run in running.values():
            first = min(first, run.outcome.ended)
        if world is None or first > until or math.isinf(first):
            self._clock = self._clock if math.isinf(until) else max(self._clock, until)
            return {}
        self._clock = first
        ended = {robot: run.outcome for robot, run in running.items() if run.outcome.ended == first}
        for robot in ended:
            run = running.pop(robot)
            world = carried(run.before, run.after, world)
        self._world = world
        return ended

    def _came_to_rest(self, start: Start) -> WorldState:
        """Water runs over what stands under it, and whatever else happens by itself."""
        self._world = at_rest(start.scene, self._begun("this")[1])
        if self.watch is not None:
            self.watch()
        return self._world

    def _slips(self, subtasks: Mapping[str, Subtask], refused: Collection[str]) -> set[str]:
        """The robots whose accepted subtask slips."""
        if self._failure_rate == 0.0:
            return set()
        moving = sorted(r for r, s in subtasks.items() if r not in refused and not s.row.still)
        return {robot for robot in moving if self._chance.random() < self._failure_rate}

    def _timed(self, outcome: Outcome, subtask: Subtask) -> Outcome:
        """An outcome with nominal seconds from now on: a refusal takes none."""
        began = ended = self._clock
        seconds, refused = 0.0, outcome.refused
        if not refused:
            seconds = self._seconds(subtask)
            ended = round(began + seconds, CLOCK_DIGITS)
        return Outcome(outcome.status, outcome.reason, outcome.detail, seconds, refused, began, ended)
