"""What does not last by itself: doors that fall shut unless a robot stays there, and what spoils unless it is ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from remac_env import oracle
from remac_env.rules.facts import ASIDE, Process, Rules
from remac_env.rules.places import destination
from remac_env.rules.processes import WHERE, WHILE
from remac_env.rules.rounds import at_rest, transition
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask
from remac_env.state import WorldState
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import All, Goal, SwitchedOn

SPARE = 3.0
"""s by which a robot wants to be early, as in physics a subtask may take that much longer than by the skill table."""

MOST_STATES = 4_000
"""States that the search for the way to end something looks at."""


def keeps_open(
    rules: Rules, world: WorldState, goal: Goal, robot: str, step: Subtask, mates: Mapping[str, Subtask]
) -> bool:
    """Whether a robot stays where it is rather than drive off: a door would fall shut through which something of the
    goal still has to go, and no robot that has it waits or comes.
    """
    if len(rules.robots) < 2 or not step.moves or world.robots[robot].holding is not None:
        return False
    here = world.robots[robot].station
    for name in falls_shut(rules, world, robot):
        wanted = {each for atom in goal.atoms() if name in atom.names() and not atom.holds(rules, world)
                  for each in atom.names() if each in rules.objects}  # fmt: skip
        able = [other for other in rules.robots if other != robot and world.robots[other].holding in wanted]
        if wanted and not any(_comes(rules, world, other, mates.get(other, WAIT), here) for other in able):
            return True
    return False


def _comes(rules: Rules, world: WorldState, robot: str, step: Subtask, place: str) -> bool:
    """Whether a robot waits, or comes to a place."""
    if step in (WAIT, STEP_ASIDE) or step.row.goes is None:
        return step == WAIT
    return destination(rules, world, robot, step.target) == place


def falls_shut(rules: Rules, world: WorldState, robot: str) -> list[str]:
    """The doors that fall shut by themselves, at once or in a while, where a robot leaves its place."""
    gone = world.with_robot(robot, station=ASIDE)
    then = at_rest(rules, gone).fixtures
    shuts = (process for process in rules.processes if process.does == "shut")
    begins = [(WHILE[each.during], name) for each in shuts for name in each.about or rules.fixtures]
    slow = [name for holds, name in begins if holds(rules, gone, name) and not holds(rules, world, name)]
    return [name for name, now in world.fixtures.items() if then[name].door != now.door or name in slow]


SLOWER = 1.8
"""How many times as long as by the skill table a subtask may take: in physics 1.3 to 1.8 times (docs/time.md)."""


def in_time(
    rules: Rules, world: WorldState, goal: Goal, step: Subtask, slow: Mapping[str, float], *, slower: float = 1.0
) -> Subtask:
    """A step of the only robot, or what it does instead where it would then come too late to end what spoils.

    slower: how many times as long as by the skill table it reckons that its subtasks take.
    """
    (robot,) = rules.robots
    own = replace(rules, processes=())
    for process, left in _spoiling(rules, world, goal, slow):
        on = [place for place in WHERE.get(process.during, _nowhere)(rules) if world.fixtures[place].on]
        if not on:
            continue
        off = All(*(Not(SwitchedOn(place)) for place in on))
        after, _ = transition(own, world, {robot: step})
        then = oracle.solve(own, after, off, max_states=MOST_STATES)
        spends = _seconds([step, *(each[robot] for each in (then.rounds if then else ()))])
        if then is not None and slower * spends + SPARE <= left:
            continue
        now = oracle.solve(own, world, off, max_states=MOST_STATES)
        first = step if now is None or not now.rounds else now.rounds[0][robot]
        ends = first.row.lasting and first.target in on
        return WAIT if ends and not process.spoils else first
    return step


def _spoiling(
    rules: Rules, world: WorldState, goal: Goal, slow: Mapping[str, float]
) -> Iterator[tuple[Process, float]]:
    """What goes on and spoils something of the goal, at its end or by what follows it, and in how many seconds."""
    for process in rules.processes:
        for name in set(process.about or rules.objects) & set(goal.names()):
            spent = slow.get(f"{process.name} {name}")
            if spent is None:
                continue
            if process.spoils:
                yield process, process.seconds - spent
            for after in rules.processes:
                if after.spoils and process.mark in after.needs and after.during == process.during:
                    yield process, process.seconds - spent + after.seconds


def _nowhere(rules: Rules) -> list[str]:
    return []


def _seconds(steps: list[Subtask]) -> float:
    return sum(step.row.seconds for step in steps)
