"""Domain and problem of an episode as text."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from remac_env.errors import OptionError, check_choice
from remac_env.pddl.actions import LEVELS, Action, actions
from remac_env.pddl.names import name_of, slot_name, station_name
from remac_env.rules.facts import ASIDE, Rules
from remac_env.state import WorldState, contents
from remac_env.tasks.compound import Not
from remac_env.tasks.goals import DoorIs, Goal, Inside, Marked, Released, SwitchedOn

_KINDS = {"r": "robot", "s": "station", "l": "slot", "f": "fixture", "n": "number", "m": "number"}


def write_domain(rules: Rules, *, level: str, relaxed: bool = False) -> str:
    """The domain of a kitchen: its predicates, and an action for each way in which a command can succeed.

    Drives are one action for each pair of stations, because of the stations that two robots cannot use at once.

    Args:
        relaxed: what actions cannot say (`unsaid`) is left out, and named in a comment; a plan may let it happen.

    Raises:
        UnknownNameError: for another level.
        OptionError: for a kitchen in which something happens that PDDL's actions cannot say, unless it is relaxed.
    """
    check_choice("level", level, LEVELS)
    left_out = unsaid(rules)
    if left_out and not relaxed:
        raise OptionError(f"PDDL's actions cannot say what nobody wants to happen: {', '.join(left_out)}; valid: "
                          "a task without such processes, or relaxed=True")  # fmt: skip
    found = actions(rules)
    needs = ":strips :typing" + (" :durative-actions" if level == "durative" else "")
    write = _durative if level == "durative" else _classical
    lines = [
        "; Written from the skill table by `remac pddl`. Seconds are those of the table.",
        *(f"; Not said: {each}. A plan may let it happen." for each in left_out),
        "(define (domain remac-kitchen)",
        f"  (:requirements {needs})",
        "  (:types robot station slot fixture item number)",
        f"  (:constants {_typed(_constants(rules))})",
        "  (:predicates",
        *(f"    ({text})" for text in _predicates(rules, found, level)),
        "  )",
    ]
    for action in found:
        lines += write(action)
    return "\n".join([*lines, ")", ""])


def write_problem(rules: Rules, world: WorldState, goal: Goal, *, level: str) -> str:
    """The problem of an episode: what is true at its start, and its goal.

    Raises:
        UnknownNameError: for another level.
        OptionError: for a goal that is no conjunction of what the domain says.
    """
    check_choice("level", level, LEVELS)
    said = {text.split()[0] for text in _predicates(rules, actions(rules), level)}
    idle = [f"idle {name_of(robot)}" for robot in rules.robots] if level == "durative" else []
    metric = ["  (:metric minimize (total-time))"] if level == "durative" else []
    lines = [
        "(define (problem episode)",
        "  (:domain remac-kitchen)",
        f"  (:objects {' '.join(map(name_of, rules.robots))} - robot)",
        "  (:init",
        *(f"    ({f})" for f in (*idle, *(f for f in facts_at(rules, world, goal) if f.split()[0] in said))),
        "  )",
        f"  (:goal (and {' '.join(f'({fact})' for fact in facts_wanted(rules, goal))}))",
        *metric,
        ")",
        "",
    ]
    return "\n".join(lines)


def facts_at(rules: Rules, world: WorldState, goal: Goal) -> tuple[str, ...]:
    """What is true in a world of a kitchen, what never changes first."""
    return (*_static(rules), *_neat(goal), *_now(rules, world))


def facts_wanted(rules: Rules, goal: Goal) -> tuple[str, ...]:
    """What must be true in the end.

    Raises:
        OptionError: for a goal that is no conjunction of what the domain says.
    """
    return tuple(dict.fromkeys(fact for atom in goal.atoms() for fact in _wanted(rules, atom)))


# -- the domain -----------------------------------------------------------------------------------------------------


def unsaid(rules: Rules) -> list[str]:
    """The processes of a kitchen that actions cannot say: what nobody wants to happen, and what undoes something."""
    return [process.name for process in rules.processes if process.spoils or process.does != "mark"]


def _constants(rules: Rules) -> dict[str, list[str]]:
    most = max((facts.holds for facts in rules.objects.values()), default=0)
    return {
        "station": [station_name(name) for name in (*rules.stations, ASIDE)],
        "slot": [slot_name(name) for name in rules.slots],
        "fixture": [name_of(name) for name in rules.fixtures],
        "item": [name_of(name) for name in rules.objects],
        "number": [f"n{number}" for number in range(most + 1)],
    }


def _typed(names: dict[str, list[str]]) -> str:
    return "\n    ".join(f"{' '.join(each)} - {kind}" for kind, each in names.items() if each)


def _predicates(rules: Rules, found: Iterable[Action], level: str) -> list[str]:
    """Every predicate with the types of its arguments, as the actions use it."""
    kinds = {name: kind for kind, names in _constants(rules).items() for name in names}
    shapes: dict[str, str] = {"idle": "idle ?a0 - robot"} if level == "durative" else {}
    for action in found:
        own = dict(action.variables)
        for fact in (*action.before, *action.after, *action.gone, *action.at_once):
            name, *arguments = fact.split()
            typed = [own[each[1:]] if each[0] == "?" else kinds[each] for each in arguments]
            shapes.setdefault(name, " ".join([name, *(f"?a{i} - {kind}" for i, kind in enumerate(typed))]))
    return list(shapes.values())


def _classical(action: Action) -> Iterator[str]:
    effects = [f"({fact})" for fact in action.after] + [f"(not ({fact}))" for fact in (*action.gone, *action.at_once)]
    yield f"  (:action {action.name}"
    yield f"    :parameters ({_head(action)})"
    yield f"    :precondition (and {' '.join(f'({fact})' for fact in action.before)})"
    yield f"    :effect (and {' '.join(effects)}))"


def _head(action: Action) -> str:
    return " ".join(f"?{name} - {kind}" for name, kind in action.variables)


def _durative(action: Action) -> Iterator[str]:
    by_robot = action.variables[0][1] == "robot"
    before = [f"(at start ({fact}))" for fact in (*(("idle ?r",) if by_robot else ()), *action.before)]
    before += [f"(over all ({fact}))" for fact in action.held]
    effects = [f"(at end ({fact}))" for fact in action.after] + [f"(at end (not ({fact})))" for fact in action.gone]
    effects += [f"(at start (not ({fact})))" for fact in action.at_once]
    effects += ["(at start (not (idle ?r)))", "(at end (idle ?r))"] if by_robot else []
    yield f"  (:durative-action {action.name}"
    yield f"    :parameters ({_head(action)})"
    yield f"    :duration (= ?duration {action.seconds:g})"
    yield f"    :condition (and {' '.join(before)})"
    yield f"    :effect (and {' '.join(effects)}))"


# -- the problem ----------------------------------------------------------------------------------------------------


def _static(rules: Rules) -> Iterator[str]:
    """What cannot change."""
    for name, slot in rules.slots.items():
        yield from (f"slot-at {slot_name(name)} {station_name(station)}" for station in slot.stations)
        yield f"slot-of {slot_name(name)} {name_of(slot.fixture)}"
    for name in rules.fixtures:
        yield from (f"used-from {name_of(name)} {station_name(station)}" for station in rules.stations_of(name))
    for name, facts in rules.objects.items():
        word = name_of(name)
        fixtures = rules.fixtures.values()
        yield from (f"fits {word} {name_of(each.name)}" for each in fixtures if each.kind not in facts.too_big_for)
        yield from (f"hand-in {word} {name_of(each.name)}" for each in fixtures if each.kind not in facts.too_deep_in)
        yield from (f"may-load {word} n{number}" for number in range(1, facts.holds + 1))
        known = {"vessel": facts.holds > 0, "food": not facts.holds, "small": facts.small, "shaker": facts.seasons}
        yield from (f"{what} {word}" for what, true in (known | {"washable": facts.washable}).items() if true)
    numbers = _constants(rules)["number"]
    yield from (f"next {one} {other}" for one, other in zip(numbers, numbers[1:], strict=False))


def _neat(goal: Goal) -> Iterator[str]:
    """The vessels on which something may lie where the goal names those that are right (`Inside.only_on`)."""
    vessels = (name for atom in goal.atoms() if isinstance(atom, Inside) for name in atom.only_on or ())
    yield from (f"neat {name_of(name)}" for name in dict.fromkeys(vessels))


def _now(rules: Rules, world: WorldState) -> Iterator[str]:
    """What is true in a world."""
    taken = {state.station for state in world.robots.values()}
    yield from (f"free {station_name(station)}" for station in rules.stations if station not in taken)
    for robot, state in world.robots.items():
        yield f"at {name_of(robot)} {station_name(state.station)}"
        yield f"empty {name_of(robot)}" if state.holding is None else f"holds {name_of(robot)} {name_of(state.holding)}"
    full = {item.place.where for item in world.objects.values() if item.place.relation == "slot"}
    burning = {slot for fixture in world.fixtures.values() for slot in fixture.on}
    for slot in rules.slots:
        yield f"{'lit' if slot in burning else 'unlit'} {slot_name(slot)}"
        yield from (f"vacant {slot_name(slot)}",) if slot not in full else ()
    for name, item in world.objects.items():
        yield from _object(rules, world, name, burning)
        yield from (f"{name_of(mark)} {name_of(name)}" for mark in sorted(item.marks))
    for name, fixture in world.fixtures.items():
        word, door = name_of(name), fixture.door
        yield f"open {word}" if door in (None, "open") else f"not-open {word}"
        if door is not None:
            yield f"shut {word}" if door == "closed" else f"not-shut {word}"
        yield f"running {word}" if fixture.on else f"off {word}"


def _object(rules: Rules, world: WorldState, name: str, burning: set[str]) -> Iterator[str]:
    word, place = name_of(name), world.objects[name].place
    yield f"load {word} n{len(contents(world, name))}"
    if place.relation != "held":
        yield f"loose {word}"
    if place.relation == "slot":
        yield f"in {word} {slot_name(place.where)}"
        yield from (f"over-fire {word}",) if place.where in burning else ()
    elif place.relation == "vessel":
        yield f"on {word} {name_of(place.where)}"
    while place.relation == "vessel":
        place = world.objects[place.where].place
    if place.relation == "slot":
        fixture = name_of(rules.slots[place.where].fixture)
        yield f"inside {word} {fixture}"
        yield from (f"neatly {word} {fixture}",) if world.objects[name].place == place else ()


def _wanted(rules: Rules, atom: Goal) -> list[str]:
    """A part of the goal as facts."""
    if isinstance(atom, Inside):
        kind = "on" if atom.container in rules.objects else "inside" if atom.only_on is None else "neatly"
        return [f"{kind} {name_of(atom.name)} {name_of(atom.container)}"]
    if isinstance(atom, Released):
        return [f"loose {name_of(atom.name)}"]
    if isinstance(atom, DoorIs):
        return [f"{'shut' if atom.door == 'closed' else 'open'} {name_of(atom.fixture)}"]
    if isinstance(atom, Marked):
        return [f"{name_of(atom.mark)} {name_of(atom.name)}"]
    if isinstance(atom, SwitchedOn):
        return [f"over-fire {name_of(atom.under)}" if atom.under else f"running {name_of(atom.fixture)}"]
    if isinstance(atom, Not) and isinstance(atom.goal, SwitchedOn) and not atom.goal.under:
        return [f"off {name_of(atom.goal.fixture)}"]
    said = re.sub(r"\s+", " ", atom.text)
    raise OptionError(f"PDDL's goals here cannot say: {said}; valid: places, doors, switches, marks, and nothing held")
