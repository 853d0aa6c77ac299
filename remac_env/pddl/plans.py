"""Plans that planners write, as commands of a kitchen."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from remac_env.errors import OptionError
from remac_env.pddl.actions import INSTANT, Action, actions
from remac_env.pddl.names import name_of, nouns, stations
from remac_env.rules.facts import Process, Rules
from remac_env.rules.places import destination
from remac_env.rules.processes import came_true
from remac_env.rules.subtasks import STEP_ASIDE, Subtask
from remac_env.state import WorldState

_LINE = re.compile(r"(?:(?P<at>\d+(?:\.\d+)?)\s*:)?\s*\((?P<what>[^()]+)\)\s*(?:\[(?P<seconds>\d+(?:\.\d+)?)\])?")


NEAR = 0.05
"""s by which a planner's times may be apart that mean the same: planners part what follows by a thousandth."""


@dataclass(frozen=True)
class Await:
    """What a step waits for: that something has gone on by itself for so many `seconds`, or has come to its end."""

    process: Process
    name: str
    seconds: float

    @property
    def what(self) -> str:
        """It in words, as infos tell what goes on: "process object"."""
        return f"{self.process.name} {self.name}"

    def over(self, world: WorldState, going_on: Mapping[str, float]) -> bool:
        """Whether it has. going_on: in these words -> for how long, s."""
        gone = going_on.get(self.what, 0.0)
        return came_true(world, self.process, self.name) or gone + NEAR >= self.seconds


@dataclass(frozen=True)
class Step:
    """An action of a plan. `at`, `seconds`: when it begins and how long it takes, s; in classical plans one by one.

    `robot`: "" for what happens by itself, with the mark that comes of it as its `skill`. `target`: what it is about,
    or the station of a drive.
    `awaits`: what has begun before it by the plan, and takes its time by itself.
    """

    at: float
    robot: str
    skill: str
    target: str
    seconds: float
    awaits: tuple[Await, ...] = ()

    def command(self, rules: Rules, world: WorldState) -> Subtask | None:
        """The command, in the world in which it is to begin; None where none leads to the drive's station."""
        if self.skill != "navigate to":
            return STEP_ASIDE if self.skill == STEP_ASIDE.skill else Subtask(self.skill, self.target)
        for noun in (*rules.fixtures, *rules.objects):
            if destination(rules, world, self.robot, noun) == self.target:
                return Subtask("navigate to", noun)
        return None

    def in_its_stead(self, rules: Rules) -> Subtask | None:
        """For a drive to one of a fixture's several stations where no command leads: the drive to that fixture.

        The kitchen itself chooses among them, and there is room to put down where it leads. None for anything else.
        """
        if self.skill != "navigate to":
            return None
        return next((Subtask("navigate to", n) for n in rules.fixtures if self.target in rules.stations_of(n)), None)


def read_plan(text: str, rules: Rules) -> list[Step]:
    """The steps of a plan as planners print it: `12.001: (action arguments) [6.000]`, or `(action arguments)`.

    Comments are left out, and so is what happens by itself.

    Raises:
        OptionError: for a line that is no action of this kitchen's domain.
    """
    known = {action.name: action for action in actions(rules)}
    lines = [line for line in (each.partition(";")[0].strip() for each in text.splitlines()) if line]
    found: list[Step] = []
    for number, line in enumerate(lines):
        before = found[-1].at + found[-1].seconds if found else 0.0
        found.append(_step(line, number, before, known, rules))
    slow = [step for step in found if not step.robot and step.seconds > INSTANT]
    steps = [replace(step, awaits=_awaits(step, slow, rules)) for step in found if step.robot]
    return sorted(steps, key=lambda step: step.at)


def _awaits(step: Step, slow: Sequence[Step], rules: Rules) -> tuple[Await, ...]:
    """For how long each of what is slow has gone on by the plan when a step begins."""
    marks = {process.mark: process for process in rules.processes}
    return tuple(
        Await(marks[each.skill], each.target, min(step.at - each.at, each.seconds))
        for each in slow
        if step.at > each.at + NEAR
    )


def printed_plan(text: str, rules: Rules) -> str:
    """The last plan among all that a planner prints: the last lines in a row that are actions of the domain.

    Planners that go on to better plans print those behind it; what they say of their search is left out.
    """
    known = {action.name for action in actions(rules)}
    found: list[str] = []
    before = False
    for line in text.splitlines():
        match = _LINE.fullmatch(line.partition(";")[0].strip())
        step = match is not None and match["what"].split()[0].lower() in known
        if step:
            found = [*found, line] if before else [line]
        before = step or (before and not line.strip())
    return "\n".join(found)


def _step(line: str, number: int, before: float, known: Mapping[str, Action], rules: Rules) -> Step:
    """A line's step; without a time of its own it begins when the one before has ended."""
    match = _LINE.fullmatch(line)
    name, *arguments = match["what"].lower().split() if match else [""]
    action = known.get(name)
    if match is None or action is None or len(arguments) != len(action.variables):
        raise OptionError(f"plan, line {number + 1}: {line[:80]!r} is not valid; valid: an action of the domain")
    given = {variable: value for (variable, _), value in zip(action.variables, arguments, strict=True)}
    robots = {name_of(robot): robot for robot in rules.robots}
    at = float(match["at"]) if match["at"] else before
    seconds = float(match["seconds"] or action.seconds)
    if not action.skill:
        (fact,) = action.after
        return Step(at, "", fact.split()[0], nouns(rules)[given["o"]], seconds)
    return Step(at, robots.get(given.get("r", ""), ""), action.skill, target_of(action, given, rules), seconds)


def target_of(action: Action, given: Mapping[str, str], rules: Rules) -> str:
    """What a robot's action with these arguments is about, variable -> PDDL name; a drive's station."""
    if action.skill == "navigate to":
        return stations(rules)[f"by-{action.name.rpartition('-to-by-')[2]}"]
    if action.skill == "place to":
        return nouns(rules)[given.get("v") or given["f"]]
    if action.skill in ("pick up", "season"):
        return nouns(rules)[given["o"]]
    for verb in ("open-", "close-", "turn-on-", "turn-off-"):
        if action.name.startswith(verb):
            return nouns(rules)[action.name.removeprefix(verb)]
    return ""
