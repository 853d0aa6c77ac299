"""The shortest makespan: exact search over decision points of the event clock, by the seconds of the skill table."""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from remac_env.backends.symbolic import Kept as BackendKept
from remac_env.backends.symbolic import Seconds, SymbolicBackend, nominal
from remac_env.events.clock import EventClock, Order
from remac_env.events.clock import Kept as ClockKept
from remac_env.events.spoiling import ShutAway
from remac_env.oracle.bounds import IMPOSSIBLE, make_bound
from remac_env.oracle.commands import relevant_commands
from remac_env.rules.claims import feasible
from remac_env.rules.facts import Process, Rules
from remac_env.rules.processes import WHERE, spoilt
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.start import Start
from remac_env.state import WorldState
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Goal, Inside, Marked, SwitchedOn, lost

SHORTEST = min(skill.seconds for skill in SKILLS.values() if not skill.still)
"""s that any subtask takes at least by the skill table."""

MAX_STATES = 60_000
"""Moments that a search looks at before it gives up."""

GREED = 3.0
"""How much more than the way behind counts the way ahead, in a search for any plan at all."""

Joint = Mapping[str, Subtask]
Proof = Literal["search", "bounds", "exhausted"]


@dataclass(frozen=True, kw_only=True)
class Makespan:
    """The shortest time in which an episode can be done, as far as it is known.

    Attributes:
        plan: (s on the clock, robot, command) in order; () where none is known.
        seconds: how long the plan takes; None where none is known.
        lower: no plan takes less, s; None where there is none at all.
        proof: "search" - the plan is a quickest one; "bounds" - the search gave up, and the truth lies between; or
            "exhausted" - there is no plan within the deadline.
        expanded: moments that were looked at.
    """

    plan: tuple[tuple[float, str, Subtask], ...]
    seconds: float | None
    lower: float | None
    proof: Proof
    expanded: int

    @property
    def optimum(self) -> float | None:
        """The shortest makespan, s; None where it is not known."""
        return self.seconds if self.proof == "search" else None


@dataclass(frozen=True)
class _Moment:
    """A decision point: where backend and clock are, and how it came about."""

    backend: BackendKept
    clock: ClockKept
    ready: tuple[str, ...]
    joint: Joint
    before: _Moment | None = None

    @property
    def now(self) -> float:
        return self.backend[2]

    @property
    def key(self) -> Hashable:
        """What two moments share that go on alike, whatever the clock shows."""
        world, running, now = self.backend
        under_way = frozenset(
            (robot, run.subtask, round(run.outcome.ended - now, 3), run.before, run.after)
            for robot, run in running.items()
        )
        waits = frozenset((r, round(d.until - now, 3)) for r, d in self.clock[0].items() if r not in running)
        ages = frozenset((process.name, name, round(now - at, 3)) for (process, name), at in self.clock[2].items())
        return world, under_way, waits, ages


def makespan(
    start: Start, goal: Goal, *, deadline: float = math.inf, max_states: int = MAX_STATES, seconds: Seconds = nominal
) -> Makespan:
    """The shortest makespan of a start for all its robots: subtasks begin at decision points, as in an episode.

    Args:
        deadline: s by which it must be done.
        max_states: moments to look at before giving up; a second search for any plan may look at as many.
        seconds: how long a subtask takes, no less than by the skill table.
    """
    found = _Search(start, goal, deadline, seconds).run(max_states)
    if found.proof != "bounds":
        return found
    some = _Search(start, goal, deadline, seconds, greed=GREED).run(max_states)
    return replace(some, lower=found.lower, proof="bounds", expanded=found.expanded + some.expanded)


class _Search:
    """A* by time. `greed` above 1 finds some plan sooner, not the quickest."""

    def __init__(self, start: Start, goal: Goal, deadline: float, seconds: Seconds, *, greed: float = 1.0) -> None:
        self._rules, self._goal, self._deadline, self._greed = start.scene, goal, deadline, greed
        self._backend = SymbolicBackend(seconds=seconds)
        world = self._backend.reset(start)
        self._clock = EventClock(self._backend, start.scene, deadline=deadline)
        self._commands = relevant_commands(start.scene, world, wider(start.scene, goal))
        self._bound, self._spoils = _Bound(start.scene, goal), ShutAway(start.scene, goal.names())

    def run(self, max_states: int) -> Makespan:
        """Search to the end, or until so many moments were looked at."""
        counter, expanded = itertools.count(), 0
        first = self._moment({}, None)
        best: dict[Hashable, float] = {first.key: 0.0}
        queue = [(self._greed * self._ahead(first), next(counter), first)]
        lower = self._ahead(first)
        while queue:
            estimate, _, moment = heapq.heappop(queue)
            if moment.now > best[moment.key] or estimate == math.inf:
                continue
            lower = max(lower, estimate) if self._greed == 1.0 else lower
            if self._goal.holds(self._rules, moment.backend[0]):
                plan = _trace(moment)
                return Makespan(plan=plan, seconds=moment.now, lower=lower, proof="search", expanded=expanded)
            if expanded >= max_states:
                return Makespan(plan=(), seconds=None, lower=round(lower, 3), proof="bounds", expanded=expanded)
            expanded += 1
            for after in self._next(moment):
                key, now = after.key, after.now
                if now >= best.get(key, math.inf):
                    continue
                ahead = self._ahead(after)
                if now + ahead > self._deadline:
                    continue
                best[key] = now
                heapq.heappush(queue, (now + self._greed * ahead, next(counter), after))
        return Makespan(plan=(), seconds=None, lower=None, proof="exhausted", expanded=expanded)

    def _next(self, moment: _Moment) -> Iterator[_Moment]:
        """The decision points that can come next."""
        for joint in self._joints(moment):
            self._backend.put_back(moment.backend)
            self._clock.put_back(moment.clock)
            told = self._clock.run({robot: Order(subtask) for robot, subtask in joint.items()})
            refused = any(not told[robot].success for robot in joint if robot in told)
            held = any(each.kind == "declined" for each in self._clock.kept()[0].values())
            world = self._backend.world
            if refused or held or lost(self._goal, self._rules, world):
                continue
            if not spoilt(self._rules, world, self._goal.names()):
                yield self._moment(joint, moment)

    def _joints(self, moment: _Moment) -> Iterator[Joint]:
        """What the robots that are ready can be told: what can succeed, and to wait where something else goes on."""
        world = moment.backend[0]
        goes_on = bool(moment.backend[1]) or bool(moment.clock[2])
        choices = [self._choices(world, robot) for robot in moment.ready]
        for joint in itertools.product(*choices):
            idle = all(subtask == WAIT for subtask in joint)
            if idle and not goes_on:
                continue
            yield dict(zip(moment.ready, joint, strict=True))

    def _choices(self, world: WorldState, robot: str) -> list[Subtask]:
        """The commands that can succeed now, one for each station, and waiting."""
        here = world.robots[robot].station
        found, seen = [WAIT], {here}
        for subtask in self._commands:
            if not feasible(self._rules, world, robot, subtask):
                continue
            if (goes := subtask.row.goes) is not None:
                station = goes(self._rules, world, robot, subtask.target)
                if station is None or station in seen:
                    continue
                seen.add(station)
            found.append(subtask)
        return found

    def _moment(self, joint: Joint, before: _Moment | None) -> _Moment:
        return _Moment(self._backend.kept(), self._clock.kept(), self._clock.ready, joint, before)

    def _ahead(self, moment: _Moment) -> float:
        """s that are needed at least from a moment on."""
        world, running, now = moment.backend
        after = self._backend.foreseen(world, running)
        if self._spoils.too_late(moment.clock[2], after, now):
            return math.inf
        return max(self._bound.subtasks(after), self._bound.processes(moment.clock, world, after, now))


class _Bound:
    """How long a goal still needs at least; never more than it does."""

    def __init__(self, rules: Rules, goal: Goal) -> None:
        atoms = [atom for atom in goal.atoms() if not (isinstance(atom, Marked) and atom.mark in rules.slow)]
        self._rounds = make_bound(rules, All(*atoms)) if atoms else lambda world: 0
        marked = [atom for atom in goal.atoms() if isinstance(atom, Marked)]
        self._slow = [(atom.name, each) for atom in marked for each in rules.processes if each.mark == atom.mark]
        self._lead = {each: [make_bound(rules, goal) for goal in set_up(rules, *each)] for each in self._slow}
        nots = [atom.goal for atom in goal.atoms() if isinstance(atom, Not)]
        off = {each.fixture for each in nots if isinstance(each, SwitchedOn)}
        self._after = {each: _turning_off(rules, each[1], off) for each in self._slow}
        self._known: dict[WorldState, float] = {}

    def subtasks(self, after: WorldState) -> float:
        """s of the subtasks that have to follow what is under way, `after` being the world once that has ended."""
        if after not in self._known:
            rounds = self._rounds(after)
            self._known[after] = math.inf if rounds >= IMPOSSIBLE else rounds * SHORTEST
        return self._known[after]

    def processes(self, clock: ClockKept, world: WorldState, after: WorldState, now: float) -> float:
        """s until what takes its time by itself is over."""
        left = [0.0]
        for name, process in self._slow:
            if process.mark not in world.objects[name].marks:
                since = next((at for (each, about), at in clock[2].items() if each == process and about == name), None)
                if since is not None:
                    left.append(process.seconds - (now - since) + self._after[name, process])
                else:
                    left.append(self._before(name, process, after) + process.seconds + self._after[name, process])
        return max(left)

    def _before(self, name: str, process: Process, after: WorldState) -> float:
        """s of the subtasks without which a process does not begin."""
        rounds = min((bound(after) for bound in self._lead[name, process]), default=0)
        return math.inf if rounds >= IMPOSSIBLE else rounds * SHORTEST


def _turning_off(rules: Rules, process: Process, off: set[str]) -> float:
    """s of turning off what a process needs to be on, where the goal wants all of that off."""
    places = WHERE[process.during](rules) if process.during in WHERE else []
    switches = {place for place in places if rules.fixtures[place].switches}
    return SKILLS["turn off"].seconds if switches and switches <= off else 0.0


def set_up(rules: Rules, name: str, process: Process) -> list[Goal]:
    """Goals of which one must hold before a process begins that is about an object."""
    places = WHERE[process.during](rules) if process.during in WHERE else []
    basins = {basin for _, wets in rules.taps for basin in wets}
    ways: list[Goal] = []
    for place in places:
        if place in basins:
            ways += [All(Inside(name, place), SwitchedOn(tap)) for tap, wets in rules.taps if place in wets]
        elif place not in dict(rules.taps):
            ways.append(All(Inside(name, place), SwitchedOn(place)))
    return ways


def wider(rules: Rules, goal: Goal) -> Goal:
    """The goal with all that it takes to give the marks that take their time, for the choice of commands."""
    wanted = {atom.mark for atom in goal.atoms() if isinstance(atom, Marked)}
    extra: list[Goal] = []
    for process in rules.processes:
        places = WHERE[process.during](rules) if process.mark in wanted and process.during in WHERE else []
        for place in places:
            facts = rules.fixtures[place]
            extra += [SwitchedOn(place)] if facts.switches else [Inside(next(iter(rules.objects)), place)]
            vessels = [n for n, o in rules.objects.items() if facts.kind in o.vessel_in and facts.switch_per_slot]
            extra += [Inside(vessel, place) for vessel in vessels]
    return All(goal, *extra)


def _trace(moment: _Moment) -> tuple[tuple[float, str, Subtask], ...]:
    steps: list[tuple[float, str, Subtask]] = []
    while moment.before is not None:
        steps = [(moment.before.now, robot, subtask) for robot, subtask in moment.joint.items()] + steps
        moment = moment.before
    return tuple(step for step in steps if step[2] != WAIT)


__all__: Sequence[str] = ("MAX_STATES", "Makespan", "makespan", "set_up", "wider")
