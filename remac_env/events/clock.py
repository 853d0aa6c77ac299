"""The event clock: runs a backend from one decision point to the next.

A decision point is a moment at which a subtask ended, an event became visible, a thought arrived, or the time is up.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any, Literal, NamedTuple

from remac_env.backends.base import Backend
from remac_env.events.processes import DIGITS, Key, ProcessQueue, in_words
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.processes import came_true
from remac_env.rules.subtasks import DONE, WAIT, Subtask

IDLE = 5.0
"""s until the next decision point where all robots wait and nothing else happens, so that time always moves."""

REFUSAL = 1.0
"""s that a command takes which is refused or means nothing: less than any subtask (6 s and more), and not nothing."""

_STILL = (WAIT.skill, DONE.skill)

Kind = Literal["thinking", "working", "waiting", "declined"]


class Order(NamedTuple):
    """What a ready robot is told to do. `think`: s until it takes effect; `invalid`: why it means nothing."""

    subtask: Subtask
    think: float = 0.0
    invalid: Outcome | None = None


class Doing(NamedTuple):
    """What a robot is at. `since`, `until`: s on the clock; `outcome`: how it ends where that is known already."""

    kind: Kind
    subtask: Subtask
    since: float
    until: float = math.inf
    outcome: Outcome | None = None

    @property
    def text(self) -> str:
        """It in words: a command, or what stands in place of one."""
        return "thinking" if self.kind == "thinking" else self.subtask.text


class Span(NamedTuple):
    """Something that lasted from `began` to `ended`, s. `who`: the robot, or what a process is about.

    `kind`: subtask, wait, thought or process. `status`: success, failure (with its reason), or cut: it was under way
    when the episode ended.
    """

    who: str
    kind: str
    what: str
    began: float
    ended: float
    status: str = "success"
    reason: str | None = None

    @property
    def as_values(self) -> dict[str, Any]:
        """It as plain values."""
        return self._asdict()


Kept = tuple[dict[str, Doing], frozenset[str], dict[Key, float]]
"""A moment of the clock."""


class EventClock:
    """Runs one episode of a backend that has been reset.

    Args:
        rules: of the kitchen.
        deadline: s on the kitchen's clock at which the episode is over.
    """

    def __init__(self, backend: Backend, rules: Rules, *, deadline: float) -> None:
        self._backend, self._robots, self._deadline = backend, rules.robots, deadline
        self._processes = ProcessQueue(rules)
        self._look()
        self._doing: dict[str, Doing] = {}
        self.done: frozenset[str] = frozenset()
        self._spans: list[Span] = []

    @property
    def timeline(self) -> tuple[Span, ...]:
        """What lasted how long by now, in the order in which it ended; what is under way comes last, as cut."""
        now, kinds = self.now, {"thinking": "thought", "waiting": "wait"}
        cut = [
            Span(robot, kinds.get(each.kind, "subtask"), each.subtask.text, each.since, now, "cut")
            for robot, each in sorted(self._doing.items())
        ]
        cut += [Span(name, "process", each.name, since, now, "cut") for (each, name), since in self.processes.items()]
        return (*self._spans, *cut)

    @property
    def processes(self) -> dict[Key, float]:
        """What takes its time by itself just now, and since when, s."""
        return self._processes.running

    @property
    def going_on(self) -> dict[str, float]:
        """The same in words (`in_words`)."""
        return in_words(self.processes, self.now)

    @property
    def now(self) -> float:
        """s since the start."""
        return self._backend.clock

    @property
    def ready(self) -> tuple[str, ...]:
        """The robots that must decide now."""
        return tuple(robot for robot in self._robots if robot not in self._doing)

    @property
    def over(self) -> bool:
        """Whether the time is up."""
        return self.now >= self._deadline

    def doing(self, robot: str) -> Doing | None:
        """What a robot is at; None for one that is ready."""
        return self._doing.get(robot)

    def kept(self) -> Kept:
        """Who is at what, and what goes on, for `put_back`."""
        return dict(self._doing), self.done, self._processes.running

    def put_back(self, kept: Kept) -> None:
        """Go on from a moment that was kept; the backend has been put back to it. What was told is forgotten."""
        doing, self.done, running = kept
        self._doing = dict(doing)
        self._processes.put_back(running)
        self._spans = []

    def run(
        self, orders: Mapping[str, Order], stops: Iterable[str] = (), unseen: Collection[str] = ()
    ) -> dict[str, Outcome]:
        """Give orders to all robots that are ready, and run to the next decision point.

        Args:
            stops: robots that are busy, and are told to stop.
            unseen: objects that nobody has seen: what happens to them is no event.

        Returns:
            The outcomes of what ended, each told once; its robots are ready now.
        """
        backend, doing, now = self._backend, self._doing, self.now
        for robot in stops:
            self._stop(robot)
        batch: dict[str, Subtask] = {}
        for robot, (subtask, think, invalid) in orders.items():
            until = round(now + think, DIGITS) if think else now
            if until > now:
                doing[robot] = Doing("thinking", subtask, now, until, invalid)
            else:
                self._give(robot, subtask, invalid, batch)
        self._begin(batch)
        told: dict[str, Outcome] = {}
        while not self._all_done():
            told = self._told(backend.advance(until=self._limit(now)))
            happened = self._happen() if self._processes.known else ()
            arrived = self._take_effect()
            if told or any(name not in unseen for name in happened) or arrived or self.over:
                break
            if self._idle and not (happened and self.now < round(now + IDLE, DIGITS)):
                break
        return self._waited(told)

    def _happen(self) -> list[str]:
        """Let processes begin and end as the world is now; what those are about that have come to their end."""
        now, about = self.now, list[str]()
        self._look()
        while ended := self._processes.over(now):
            for process, name, since in ended:
                about.append(name)
                self._backend.happen(process, name)
                how = () if came_true(self._backend.world, process, name) else ("failure", "blocked")
                self._spans.append(Span(name, "process", process.name, since, now, *how))
            self._look()
        return about

    def _look(self) -> None:
        """What goes on as the world is now."""
        self._processes.look(self._backend.settled, self.now)
        if self._processes.moves:
            self._backend.go_on(self.processes)

    def _take_effect(self) -> bool:
        """Let orders begin whose thinking is over; whether there are any."""
        now = self.now
        due = [(robot, each) for robot, each in self._doing.items() if each.kind == "thinking" and each.until <= now]
        batch: dict[str, Subtask] = {}
        for robot, (_, subtask, since, _, outcome) in due:
            self._spans.append(Span(robot, "thought", subtask.text, since, now))
            self._give(robot, subtask, outcome, batch)
        self._begin(batch)
        return bool(due)

    def _give(self, robot: str, subtask: Subtask, invalid: Outcome | None, batch: dict[str, Subtask]) -> None:
        """Let a robot wait, or be refused, or put it into the batch of those that begin to work."""
        still = subtask.skill in _STILL
        if invalid is not None:
            self._decline(robot, subtask, invalid)
        elif still:
            self._doing[robot] = Doing("waiting", subtask, self.now)
        else:
            self._doing[robot] = Doing("working", subtask, self.now)
            batch[robot] = subtask
        # Who has said `done` stays done for as long as it waits.
        if still and subtask == DONE:
            self.done |= {robot}
        elif robot in self.done and (subtask != WAIT or invalid is not None):
            self.done -= {robot}

    def _begin(self, batch: Mapping[str, Subtask]) -> None:
        """Let the backend begin these together."""
        if batch:
            for robot, refused in self._backend.begin(batch).items():
                self._decline(robot, batch[robot], refused)

    def _stop(self, robot: str) -> None:
        """A thought ends in a moment without a command; what has begun ends at its controller's next safe pose."""
        each, now = self._doing[robot], self.now
        if each.kind == "thinking":
            self._spans.append(Span(robot, "thought", each.subtask.text, each.since, now, "failure", "interrupted"))
            self._decline(robot, each.subtask, failure("interrupted", "it was told to stop"))
        elif each.kind == "working":
            self._backend.stop(robot)

    def _decline(self, robot: str, subtask: Subtask, outcome: Outcome) -> None:
        """A command that comes to nothing still takes a moment."""
        until = round(self.now + REFUSAL, DIGITS)
        ends = replace(outcome, seconds=REFUSAL, began=self.now, ended=until)
        self._doing[robot] = Doing("declined", subtask, self.now, until, ends)

    def _told(self, ended: Mapping[str, Outcome]) -> dict[str, Outcome]:
        """The outcomes of what has ended by now."""
        now, told = self.now, dict[str, Outcome]()
        for robot, outcome in ended.items():
            if outcome.ended <= outcome.began:
                self._decline(robot, self._doing[robot].subtask, outcome)  # given up before anything moved
            else:
                told[robot] = outcome
        for robot, each in self._doing.items():
            if each.kind == "declined" and each.until <= now and each.outcome is not None:
                told[robot] = each.outcome
        for robot, outcome in told.items():
            self._note(robot, "subtask", outcome)
        return told

    def _note(self, robot: str, kind: str, outcome: Outcome) -> None:
        """What a robot was at has ended."""
        what = self._doing.pop(robot).subtask.text
        self._spans.append(
            Span(robot, kind, what, outcome.began, outcome.ended, outcome.status, outcome.reason)
        )

    def _waited(self, told: dict[str, Outcome]) -> dict[str, Outcome]:
        """What was told, and that those are asked again that have waited for this decision point."""
        waits = [(robot, each.since) for robot, each in self._doing.items() if each.kind == "waiting"]
        now, over = self.now, bool(waits) and self._all_done()
        for robot, since in waits:
            if since >= now and not over:
                continue
            told[robot] = Outcome("success", None, "", round(now - since, DIGITS), False, since, now)
            self._note(robot, "wait", told[robot])
        return told

    def _limit(self, began: float) -> float:
        """What the clock shows at most before something is due. began: when this decision point was left, s."""
        first = min(self._processes.next, self._deadline) if self._processes.known else self._deadline
        for each in self._doing.values():
            if each.until < first:
                first = each.until
        return min(first, round(began + IDLE, DIGITS)) if self._idle else first

    @property
    def _idle(self) -> bool:
        """Whether nobody does more than wait."""
        return all(each.kind == "waiting" for each in self._doing.values())

    def _all_done(self) -> bool:
        return len(self.done) == len(self._robots)
