"""Plans for the event clock that benchmarks/timed_physics.py carries out: those of a data file, and the oracle's."""

from __future__ import annotations

import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from remac_env.backends.symbolic import SymbolicBackend, nominal
from remac_env.errors import OptionError
from remac_env.events.clock import EventClock, Order, Span
from remac_env.events.makespan import makespan
from remac_env.rules.facts import Rules
from remac_env.rules.processes import WHERE
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.start import Start
from remac_env.tasks.goals import Goal
from remac_env.vocabulary import Vocabulary

PLANS = Path(__file__).with_name("timed_plans.toml")


@dataclass(frozen=True)
class Step:
    """A command of a plan, whose it is, and what must have ended before it: (what, how many times)."""

    robot: str
    subtask: Subtask
    after: frozenset[tuple[str, int]]


class Agenda:
    """What is left of a plan: each robot's commands in order, each of which begins once what it waits for ended."""

    def __init__(self, steps: Iterable[Step]) -> None:
        self._left = defaultdict[str, list[Step]](list)
        for step in steps:
            self._left[step.robot].append(step)

    def able(self, ready: Iterable[str], timeline: Iterable[Span]) -> dict[str, Step]:
        """The next steps of those robots that are ready and can begin theirs now."""
        ended = Counter(map(_said, _good(timeline)))
        first = {robot: self._left[robot][0] for robot in ready if self._left[robot]}
        return {robot: step for robot, step in first.items() if all(ended[what] >= n for what, n in step.after)}

    def done(self, robot: str) -> None:
        """A robot is through with its next step."""
        self._left[robot].pop(0)


def plan_of(task: str, start: Start, words: Vocabulary) -> list[Step]:
    """The plan of a task for two robots, from the data file."""
    steps: list[Step] = []
    for robot, text in _data()[task].items():
        until: set[tuple[str, int]] = set()
        for command in (" ".join(part.split()) for part in text.split(";")):
            if command.startswith("until "):
                until.add((command.removeprefix("until "), 1))
                continue
            subtask = words.parse(command)
            if subtask is None:
                raise OptionError(f"{PLANS.name}, {task}: {command!r} is no command; valid: those of {start.layout}")
            steps.append(Step(robot, subtask, frozenset(until)))
            until = set()
    return steps


def shortest(start: Start, goal: Goal, deadline: float, max_states: int) -> list[Step]:
    """The plan with the shortest makespan, or one that a search finds which gives up; empty where it finds none.

    Commands take what they take in physics, as it stands in the data file: by the table's seconds plans have a robot
    do something else so long that in physics it comes too late. A command waits for all processes, and all that other
    robots have done but driven, that ended before it; and for a process that ends while it ends what that needs, as
    when a tap is turned off. Where two are at one place, the kitchen refuses and it is tried again.
    """
    found = makespan(start, goal, deadline=deadline, max_states=max_states, seconds=_in_physics).plan
    ends = [span for span in _good(_timeline(start, found, deadline)) if not span.what.startswith("navigate")]
    return [
        Step(robot, subtask, frozenset(Counter(
            _said(span) for span in ends if span.who != robot and _first(start.scene, span, at, subtask)
        ).items()))
        for at, robot, subtask in found
    ]  # fmt: skip


def _first(rules: Rules, span: Span, at: float, subtask: Subtask) -> bool:
    """Whether something has to have ended before a command begins that begins then in a plan."""
    if span.ended <= at or span.kind != "process" or subtask.moves:
        return span.ended <= at
    during = next(each.during for each in rules.processes if each.name == span.what)
    places = WHERE[during](rules) if during in WHERE else []
    return subtask.target in (span.who, *places) and span.ended <= at + _in_physics(subtask)


def _timeline(start: Start, plan: Sequence[tuple[float, str, Subtask]], deadline: float) -> tuple[Span, ...]:
    """How a plan goes by these seconds."""
    backend, left = SymbolicBackend(seconds=_in_physics), list(plan)
    backend.reset(start)
    clock = EventClock(backend, start.scene, deadline=deadline)
    while left and not clock.over:
        due = {robot: step for at, robot, step in left if at <= clock.now and robot in clock.ready}
        left = [each for each in left if each[0] > clock.now or each[1] not in due]
        clock.run({robot: Order(due.get(robot, WAIT)) for robot in clock.ready})
    return clock.timeline


def _in_physics(subtask: Subtask) -> float:
    return float(_data()["seconds"].get(subtask.skill, nominal(subtask)))


@lru_cache(maxsize=1)
def _data() -> dict[str, Any]:
    return tomllib.loads(PLANS.read_text("utf-8"))


def _good(timeline: Iterable[Span]) -> Iterable[Span]:
    return (span for span in timeline if span.kind in ("subtask", "process") and span.status == "success")


def _said(span: Span) -> str:
    """What has ended, as a data file says it."""
    return span.what if span.kind == "subtask" else f"{span.what} {span.who}"
