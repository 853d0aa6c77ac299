"""The actions of the PDDL domain: what the rows of the skill table require and change, over slots and stations.

Requirements marked `refuse` and `attempt` are preconditions; what is only advised is left out, as nothing stops it.
Every precondition is positive, and there is no equality: what some action needs false has a fact that says so.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from remac_env.pddl.names import name_of, slot_name, station_name
from remac_env.rules.facts import ASIDE, FixtureFacts, Process, Rules
from remac_env.rules.marks import SEASONED, WASHED
from remac_env.rules.skills import SKILLS

LEVELS = ("strips", "durative")
"""strips: actions one after the other, for classical planners; durative: with seconds, for temporal ones."""

INSTANT = 0.001
"""s that a durative action takes which takes no time in the kitchen."""

Facts = tuple[str, ...]
Variables = tuple[tuple[str, str], ...]

_ROBOT: Variables = (("r", "robot"), ("s", "station"))
_THERE: Variables = (("l", "slot"), ("f", "fixture"))
_AT_WORK: Facts = ("at ?r ?s", "slot-at ?l ?s", "slot-of ?l ?f", "open ?f")
_IN_VESSEL: Facts = ("on ?o ?v", "in ?v ?l")


@dataclass(frozen=True, kw_only=True)
class Action:
    """One action. `skill`: the command that it is, "" for what happens by itself.

    `before`, `after`, `gone`: facts that must be true, and those that become true and false. `held`: facts that must
    stay true all the time; `at_once`: those that become false when it begins.
    """

    name: str
    variables: Variables
    before: Facts
    after: Facts
    gone: Facts = ()
    held: Facts = ()
    at_once: Facts = ()
    seconds: float
    skill: str = ""


def actions(rules: Rules) -> list[Action]:
    """Every action of a kitchen."""
    found = [*_drives(rules), *_picking(), *_placing(), *_seasoning()]
    for facts in rules.fixtures.values():
        found += [*_doors(facts), *_switches(rules, facts)]
    return [*found, *_water(rules), *_heat(rules)]


def _drives(rules: Rules) -> Iterator[Action]:
    """From each station to each other one; who sets out takes the goal, and keeps the start until it has left."""
    for goal in (*rules.stations, ASIDE):
        for start in (*rules.stations, ASIDE):
            if start == goal:
                continue
            near = [other for other in rules.stations if other != start and rules.conflicting(goal, other)]
            one, other = station_name(start), station_name(goal)
            claims = (f"free {other}",) if goal != ASIDE else ()
            left = (f"free {one}",) if start != ASIDE else ()
            yield Action(
                name=f"drive-{one}-to-{other}",
                variables=(("r", "robot"),),
                before=(f"at ?r {one}", *dict.fromkeys((*claims, *(f"free {station_name(each)}" for each in near)))),
                after=(f"at ?r {other}", *left),
                at_once=(f"at ?r {one}", *claims),
                seconds=_seconds("navigate aside" if goal == ASIDE else "navigate to"),
                skill="navigate aside" if goal == ASIDE else "navigate to",
            )


def _seconds(skill: str) -> float:
    return SKILLS[skill].seconds


def _picking() -> Iterator[Action]:
    common: Facts = ("empty ?r", *_AT_WORK, "fits ?o ?f", "load ?o n0")
    taken: Facts = ("empty ?r", "inside ?o ?f", "neatly ?o ?f", "loose ?o")
    yield Action(
        name="pick-up", variables=(*_ROBOT, ("o", "item"), *_THERE), before=(*common, "in ?o ?l"),
        after=("holds ?r ?o", "vacant ?l"), gone=(*taken, "in ?o ?l", "over-fire ?o"),
        seconds=_seconds("pick up"), skill="pick up",
    )  # fmt: skip
    yield Action(
        name="pick-up-from-vessel",
        variables=(*_ROBOT, ("o", "item"), ("v", "item"), *_THERE, ("n", "number"), ("m", "number")),
        before=(*common, *_IN_VESSEL, "load ?v ?m", "next ?n ?m", "hand-in ?v ?f"),
        after=("holds ?r ?o", "load ?v ?n"), gone=(*taken, "on ?o ?v", "load ?v ?m"),
        seconds=_seconds("pick up"), skill="pick up",
    )  # fmt: skip


def _placing() -> Iterator[Action]:
    common: Facts = ("holds ?r ?o", *_AT_WORK, "fits ?o ?f")
    left: Facts = ("empty ?r", "inside ?o ?f", "loose ?o")
    for name, lit, more in (("place", "unlit ?l", ()), ("place-on-fire", "lit ?l", ("over-fire ?o",))):
        yield Action(
            name=name, variables=(*_ROBOT, ("o", "item"), *_THERE), before=(*common, "vacant ?l", lit),
            after=(*left, "in ?o ?l", "neatly ?o ?f", *more), gone=("holds ?r ?o", "vacant ?l"),
            seconds=_seconds("place to"), skill="place to",
        )  # fmt: skip
    room: Facts = ("in ?v ?l", "small ?o", "load ?v ?n", "next ?n ?m", "may-load ?v ?m", "hand-in ?v ?f")
    for name, neat, more in (("place-into-vessel", (), ()), ("place-neatly", ("neat ?v",), ("neatly ?o ?f",))):
        yield Action(
            name=name, before=(*common, *room, *neat), after=(*left, "on ?o ?v", "load ?v ?m", *more),
            variables=(*_ROBOT, ("o", "item"), ("v", "item"), *_THERE, ("n", "number"), ("m", "number")),
            gone=("holds ?r ?o", "load ?v ?n"), seconds=_seconds("place to"), skill="place to",
        )  # fmt: skip


def _seasoning() -> Iterator[Action]:
    common: Facts = ("holds ?r ?t", "shaker ?t", *_AT_WORK)
    tool: Variables = (("t", "item"), ("o", "item"))
    mark: Facts = (f"{SEASONED} ?o",)
    yield Action(name="season", variables=(*_ROBOT, *tool, *_THERE), before=(*common, "in ?o ?l"),
                 after=mark, seconds=_seconds("season"), skill="season")  # fmt: skip
    yield Action(name="season-in-vessel", variables=(*_ROBOT, *tool, ("v", "item"), *_THERE),
                 before=(*common, *_IN_VESSEL), after=mark, seconds=_seconds("season"), skill="season")  # fmt: skip


def _doors(facts: FixtureFacts) -> Iterator[Action]:
    if not facts.door:
        return
    name = name_of(facts.name)
    there: Facts = ("at ?r ?s", f"used-from {name} ?s", "empty ?r")
    stops = facts.shut_to_run and bool(facts.switches)
    yield Action(
        name=f"open-{name}", variables=_ROBOT, before=(*there, f"not-open {name}"),
        after=(f"open {name}", f"not-shut {name}", *((f"off {name}",) if stops else ())),
        gone=(f"not-open {name}", f"shut {name}", *((f"running {name}",) if stops else ())),
        seconds=_seconds("open door"), skill="open door",
    )  # fmt: skip
    yield Action(
        name=f"close-{name}", variables=_ROBOT, before=(*there, f"not-shut {name}"),
        after=(f"shut {name}", f"not-open {name}"), gone=(f"not-shut {name}", f"open {name}"),
        seconds=_seconds("close door"), skill="close door",
    )  # fmt: skip


def _switches(rules: Rules, facts: FixtureFacts) -> Iterator[Action]:
    if not facts.switches:
        return
    name = name_of(facts.name)
    there: Facts = ("at ?r ?s", f"used-from {name} ?s", "empty ?r")
    shut: Facts = (f"shut {name}",) if facts.shut_to_run else ()
    turned: Facts = (f"running {name}",)
    slots = [slot_name(slot) for slot in facts.slots] if facts.switch_per_slot else []
    if slots:
        vessels = [name_of(each) for each, kind in rules.objects.items() if kind.holds]
        yield Action(
            name=f"turn-on-{name}", variables=(*_ROBOT, ("v", "item"), ("l", "slot")),
            before=(*there, *shut, "vessel ?v", "in ?v ?l", f"slot-of ?l {name}", "unlit ?l"),
            after=(*turned, "lit ?l", "over-fire ?v"), gone=(f"off {name}", "unlit ?l"),
            seconds=_seconds("turn on"), skill="turn on",
        )  # fmt: skip
        out = [f"lit {slot}" for slot in slots] + [f"over-fire {vessel}" for vessel in vessels]
    else:
        yield Action(
            name=f"turn-on-{name}", variables=_ROBOT, before=(*there, *shut, f"off {name}"), after=turned,
            gone=(f"off {name}",), seconds=_seconds("turn on"), skill="turn on",
        )  # fmt: skip
        out = []
    yield Action(
        name=f"turn-off-{name}", variables=_ROBOT, before=(*there, *turned),
        after=(f"off {name}", *(f"unlit {slot}" for slot in slots)), gone=(*turned, *out),
        seconds=_seconds("turn off"), skill="turn off",
    )  # fmt: skip


# -- what happens by itself -----------------------------------------------------------------------------------------


def _water(rules: Rules) -> Iterator[Action]:
    """Water washes what stands under it, directly or in a vessel, and fills vessels where that takes its time."""
    for tap, basins in rules.taps:
        for basin in basins:
            running: Facts = (f"running {name_of(tap)}", f"slot-of ?l {name_of(basin)}")
            marks = [(WASHED, "washable ?o")] + [("filled", "vessel ?o")] * (_slow(rules, "filled") is not None)
            for mark, what in marks:
                slow = _slow(rules, mark)
                seconds = INSTANT if slow is None else slow.seconds
                yield from _by_itself(f"{name_of(tap)}-{mark}", mark, (*running, what), seconds, vessel=mark == WASHED)


def _slow(rules: Rules, mark: str) -> Process | None:
    return next((process for process in rules.processes if process.mark == mark), None)


def _heat(rules: Rules) -> Iterator[Action]:
    """Food is heated, where that takes its time: in a vessel over a fire, or in what runs when it is shut."""
    slow = _slow(rules, "heated")
    if slow is None:
        return
    for facts in rules.fixtures.values():
        if facts.switches and facts.slots:
            name = name_of(facts.name)
            on: Facts = ("lit ?l",) if facts.switch_per_slot else (f"running {name}", f"slot-of ?l {name}")
            yield from _by_itself(f"{name}-heated", "heated", (*on, "food ?o"), slow.seconds, vessel=True,
                                  bare=not facts.switch_per_slot)  # fmt: skip


def _by_itself(
    name: str, mark: str, during: Facts, seconds: float, *, vessel: bool, bare: bool = True
) -> Iterator[Action]:
    if bare:
        held: Facts = (*during, "in ?o ?l")
        yield Action(name=name, variables=(("o", "item"), ("l", "slot")), before=held, held=held,
                     after=(f"{mark} ?o",), seconds=seconds)  # fmt: skip
    if vessel:
        held = (*during, *_IN_VESSEL)
        yield Action(name=f"{name}-in-vessel", variables=(("o", "item"), ("v", "item"), ("l", "slot")),
                     before=held, held=held, after=(f"{mark} ?o",), seconds=seconds)  # fmt: skip
