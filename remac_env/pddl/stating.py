"""A plan of commands as actions of the exported domain, each found by the facts that are true when it begins.

It is the semantics of the durative level, by itself: what begins needs its preconditions, effects come at start and
end, and what happens by itself begins as soon as it can. So it tells whether a plan of the kitchen's is one of the
exported problem's.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass

from remac_env.pddl.actions import Action, actions
from remac_env.pddl.names import name_of
from remac_env.pddl.plans import Step, target_of
from remac_env.pddl.writing import facts_at, facts_wanted
from remac_env.rules.facts import Rules
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal

APART = 0.001
"""s between what ends and what begins then: durative actions may not meet in one moment."""

MOST_CHOICES = 5_000
"""Choices of what commands leave open that are tried at most."""


@dataclass(frozen=True)
class Stated:
    """A plan as text of the durative level. `problem`: why it is none of the problem's, "" where it is one."""

    text: str
    problem: str


def state_plan(rules: Rules, world: WorldState, goal: Goal, steps: Sequence[Step]) -> Stated:
    """State a plan in PDDL's terms.

    Into which of several slots a command puts an object, it does not say: the choices are tried, those first that make
    more of the goal true.

    Args:
        world: in which it begins.
        steps: with the seconds at which they begin, and the stations of drives.

    Raises:
        OptionError: for a goal that PDDL cannot say here.
    """
    idle = (f"idle {name_of(robot)}" for robot in rules.robots)
    start = _Facts(rules, frozenset((*facts_at(rules, world, goal), *idle)))
    ranks = {at: rank for rank, at in enumerate(sorted({step.at for step in steps}))}
    due = [(round(step.at + 2 * APART * ranks[step.at], 6), step) for step in sorted(steps, key=lambda each: each.at)]
    search = _Search(due, frozenset(facts_wanted(rules, goal)))
    found = search.run(start, 0)
    return Stated(found.text if found is not None else "", "" if found is not None else search.problem)


class _Search:
    """Depth first over what commands leave open. `problem`: why no choice leads to the goal, of the one that got on."""

    def __init__(self, due: Sequence[tuple[float, Step]], wanted: frozenset[str]) -> None:
        self._due, self._wanted = due, wanted
        self.problem, self._furthest, self._tries = "", -1, 0

    def run(self, kitchen: _Facts, index: int) -> _Facts | None:
        """The end of a plan's rest that reaches the goal."""
        if index == len(self._due):
            kitchen.pass_until(float("inf"))
            missing = sorted(self._wanted - kitchen.true)
            self._note(index, f"not true in the end: {', '.join(missing)}")
            return None if missing else kitchen
        now, step = self._due[index]
        kitchen.pass_until(now)
        choices = kitchen.choices(step)
        self._note(index, f"{step.skill} {step.target} at {step.at:g} s: no action of the domain does that then")
        for action, given in sorted(choices, key=lambda each: -self._worth(*each)):
            self._tries += 1
            if self._tries > MOST_CHOICES:
                return None
            after = kitchen.copy()
            after.start(action, given, now)
            found = self.run(after, index + 1)
            if found is not None:
                return found
        return None

    def _note(self, index: int, problem: str) -> None:
        if index > self._furthest:
            self._furthest, self.problem = index, problem

    def _worth(self, action: Action, given: Mapping[str, str]) -> int:
        """How many parts of the goal an action makes true."""
        return len(self._wanted & {_filled(fact, given) for fact in action.after})


@dataclass(frozen=True)
class _Running:
    """An action under way."""

    action: Action
    given: Mapping[str, str]
    line: tuple[float, str]

    def facts(self, told: Iterable[str]) -> list[str]:
        """Facts of the action with its arguments in place of its variables."""
        return [_filled(fact, self.given) for fact in told]


class _Facts:
    """What is true, and what is under way, at one moment."""

    def __init__(self, rules: Rules, true: Iterable[str]) -> None:
        self._rules, self.true = rules, set(true)
        self._actions = actions(rules)
        self._number = 0
        self._ends: list[tuple[float, int, _Running]] = []
        self._lines: list[tuple[float, str]] = []

    def copy(self) -> _Facts:
        """The same moment, to go on from in another way."""
        other = copy(self)
        other.true, other._ends, other._lines = set(self.true), list(self._ends), list(self._lines)
        return other

    @property
    def text(self) -> str:
        """What has begun by now, as lines of a plan."""
        return "\n".join((*(line for _, line in sorted(self._lines)), ""))

    def pass_until(self, now: float) -> None:
        """Let all end that ends before, and begin what can by itself."""
        self._begin_alone(self._ends[0][0] if self._ends else 0.0)
        while self._ends and self._ends[0][0] < now:
            at, _, ended = heapq.heappop(self._ends)
            self.true -= set(ended.facts(ended.action.gone))
            self.true |= set(ended.facts(ended.action.after))
            if "r" in ended.given:
                self.true.add(f"idle {ended.given['r']}")
            self._drop_broken()
            self._begin_alone(at)

    def choices(self, step: Step) -> list[tuple[Action, dict[str, str]]]:
        """The actions, with their arguments, that are a robot's command and possible now."""
        robot = name_of(step.robot)
        return [
            (action, given)
            for action in self._actions
            if action.skill == step.skill and f"idle {robot}" in self.true
            for given in self._matches(action, {"r": robot})
            if target_of(action, given, self._rules) == step.target
        ]

    def start(self, action: Action, given: Mapping[str, str], now: float) -> None:
        """Begin an action."""
        arguments = " ".join((action.name, *(given[variable] for variable, _ in action.variables)))
        running = _Running(action, given, (now, f"{now:.3f}: ({arguments}) [{action.seconds:g}]"))
        self._lines.append(running.line)
        self.true -= set(running.facts(action.at_once))
        self.true -= {f"idle {given['r']}"} if "r" in given else set()
        self._number += 1
        heapq.heappush(self._ends, (round(now + action.seconds, 6), self._number, running))
        self._drop_broken()

    def _begin_alone(self, at: float) -> None:
        """What happens by itself begins as soon as it can, where it has not happened and does not go on yet."""
        under_way = {fact for _, _, running in self._ends for fact in running.facts(running.action.after)}
        for action in self._actions:
            if action.skill:
                continue
            for given in list(self._matches(action, {})):
                done = [_filled(fact, given) for fact in action.after]
                if not set(done) <= self.true | under_way:
                    under_way |= set(done)
                    self.start(action, given, round(at + APART, 6))

    def _drop_broken(self) -> None:
        """What happens by itself has not happened where something that it needs has ceased to be so."""
        broken = [each for each in self._ends if not set(each[2].facts(each[2].action.held)) <= self.true]
        for each in broken:
            self._ends.remove(each)
            self._lines.remove(each[2].line)
        heapq.heapify(self._ends)

    def _matches(self, action: Action, given: Mapping[str, str]) -> Iterator[dict[str, str]]:
        """The arguments with which all that an action needs is true now."""
        table: dict[str, list[list[str]]] = {}
        for fact in sorted(self.true):
            name, *arguments = fact.split()
            table.setdefault(name, []).append(arguments)
        yield from _matching(action.before, dict(given), table)


def _matching(
    before: Sequence[str], given: dict[str, str], table: Mapping[str, list[list[str]]]
) -> Iterator[dict[str, str]]:
    if not before:
        yield given
        return
    name, *arguments = before[0].split()
    for found in table.get(name, ()):
        bound = dict(given)
        if all(_fits(argument, value, bound) for argument, value in zip(arguments, found, strict=True)):
            yield from _matching(before[1:], bound, table)


def _fits(argument: str, value: str, bound: dict[str, str]) -> bool:
    """Whether a fact's argument is this value; a variable that has none yet gets it."""
    if argument[0] != "?":
        return argument == value
    return bound.setdefault(argument[1:], value) == value


def _filled(fact: str, given: Mapping[str, str]) -> str:
    return " ".join(given[part[1:]] if part[0] == "?" else part for part in fact.split())
