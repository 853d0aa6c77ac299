"""Processes: what takes its time by itself while something is so, and what comes of it. The rows are a data file."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from importlib import resources

from remac_env.errors import KitchenFileError, check_choice
from remac_env.rules.facts import FixtureFacts, Process, Rules
from remac_env.state import WorldState, supports

FILE = "processes.toml"
DOES = ("mark", "shut", "off")
SHOWS = ("", "steam", "smoke", "film", "level", "spill", "ice", "digits")

Holds = Callable[[Rules, WorldState, str], bool]


# -- while what is so -----------------------------------------------------------------------------------------------


def _around(rules: Rules, world: WorldState, name: str) -> tuple[list[str], FixtureFacts | None]:
    """What an object is on or in, and the fixture at the end of it; no fixture for what is held or on the floor."""
    around = supports(rules, world, name)
    return around, rules.fixtures.get(around[-1]) if around else None


def _on_heat(rules: Rules, world: WorldState, name: str) -> bool:
    if name not in rules.objects or rules.objects[name].holds:
        return False
    around, fixture = _around(rules, world, name)
    if fixture is None or fixture.wets or not world.fixtures[fixture.name].on:
        return False
    bare = len(around) == 2 and fixture.kind in rules.objects[name].needs_vessel_in
    lit = not fixture.switch_per_slot or any(slot in world.fixtures[fixture.name].on for slot in around)
    return lit and not bare


def _in_water(rules: Rules, world: WorldState, name: str) -> bool:
    around, _ = _around(rules, world, name)
    basins = {basin for tap, wets in rules.taps if world.fixtures[tap].on for basin in wets}
    return bool(basins.intersection(around))


def _under_water(rules: Rules, world: WorldState, name: str) -> bool:
    return name in rules.objects and rules.objects[name].washable and _in_water(rules, world, name)


def _vessel_under_water(rules: Rules, world: WorldState, name: str) -> bool:
    return name in rules.objects and rules.objects[name].holds > 0 and _in_water(rules, world, name)


def _in_the_open(rules: Rules, world: WorldState, name: str) -> bool:
    if name not in rules.objects:
        return False
    _, fixture = _around(rules, world, name)
    return fixture is None or world.fixtures[fixture.name].door != "closed"


def _open_and_left_alone(rules: Rules, world: WorldState, name: str) -> bool:
    if name not in rules.fixtures or world.fixtures[name].door in (None, "closed"):
        return False
    there = rules.stations_of(name)
    return not any(robot.station in there for robot in world.robots.values())


def _at_work(rules: Rules, world: WorldState, name: str) -> bool:
    return name in rules.fixtures and rules.fixtures[name].shut_to_run and bool(world.fixtures[name].on)


WHILE: Mapping[str, Holds] = {
    "on heat": _on_heat,
    "under water": _under_water,
    "vessel under water": _vessel_under_water,
    "in the open": _in_the_open,
    "open and left alone": _open_and_left_alone,
    "at work": _at_work,
}
"""What must be so while a process goes on, of an object or a fixture; false for whatever it cannot be said of."""


Where = Callable[[Rules], list[str]]


def _heaters(rules: Rules) -> list[str]:
    return [name for name, facts in rules.fixtures.items() if facts.switches and facts.slots]


def _taps(rules: Rules) -> list[str]:
    return [name for tap, wets in rules.taps for name in (tap, *wets)]


WHERE: Mapping[str, Where] = {
    "on heat": _heaters,
    "under water": _taps,
    "vessel under water": _taps,
}
"""The fixtures that are needed to make it so; none where nobody has to do anything."""


SHUT_AWAY = frozenset({"in the open"})
"""What ceases to be so of an object only once it is behind a shut door."""


# -- the rows -------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def known() -> Mapping[str, Process]:
    """Every process by its name.

    Raises:
        KitchenFileError: for a row that lacks something or says what there is not.
    """
    data = tomllib.loads(resources.files("remac_env").joinpath("rules", FILE).read_text("utf-8"))
    return {name: make_process(name, row) for name, row in data.items()}


def make_process(name: str, row: Mapping[str, object]) -> Process:
    """A process from its table in a TOML file; KitchenFileError for what is not one."""
    lacks = [key for key in ("while", "does", "seconds", "source", "text", "told") if not row.get(key)]
    if lacks:
        raise KitchenFileError(FILE, name, f"it lacks {', '.join(lacks)}")
    for key, choices in (("while", tuple(WHILE)), ("does", DOES), ("shows", SHOWS)):
        if row.get(key, "") not in choices:
            raise KitchenFileError(FILE, f"{name}, {key}", f"got {row[key]!r}", choices)
    seconds = row["seconds"]
    if not isinstance(seconds, int | float) or not seconds > 0:
        raise KitchenFileError(FILE, f"{name}, seconds", f"got {seconds!r}, which is no time")
    if (row["does"] == "mark") != bool(row.get("mark")):
        raise KitchenFileError(FILE, f"{name}, mark", "there is one if it does mark, and else none")
    needs = row.get("needs", [])
    return Process(
        name=name,
        during=str(row["while"]),
        does=str(row["does"]),
        seconds=float(seconds),
        mark=str(row.get("mark", "")),
        needs=frozenset(needs if isinstance(needs, list) else ()),
        spoils=bool(row.get("spoils", False)),
        shows=str(row.get("shows", "")),
        text=str(row["text"]),
        told=str(row["told"]).format(seconds=f"{float(seconds):g}"),
    )


def chosen(wanted: Sequence[tuple[str, tuple[str, ...]]]) -> tuple[Process, ...]:
    """The processes of a kitchen: (name, what they are about), about everything where that is empty.

    Raises:
        UnknownNameError: for a process that there is not; lists the valid ones.
    """
    rows = known()
    for name, _ in wanted:
        check_choice("process", name, rows)
    return tuple(rows[name].of(about) for name, about in wanted)


# -- what goes on, and what comes of it -----------------------------------------------------------------------------


def going_on(rules: Rules, world: WorldState) -> Iterator[tuple[Process, str]]:
    """The processes that go on in a world, and what each is about."""
    for process in rules.processes:
        holds = WHILE[process.during]
        for name in process.about or (*rules.objects, *rules.fixtures):
            if not _is_over(world, process, name) and holds(rules, world, name):
                yield process, name


def _is_over(world: WorldState, process: Process, name: str) -> bool:
    """Whether it has come of it already, or cannot begin yet."""
    marks = world.objects[name].marks if name in world.objects else frozenset[str]()
    return process.mark in marks or not process.needs <= marks


def outcome_of(world: WorldState, process: Process, name: str) -> WorldState:
    """The world in which a process has come to its end."""
    if process.does == "mark":
        return world.with_object(name, marks=world.objects[name].marks | {process.mark})
    if process.does == "shut":
        return world.with_fixture(name, door="closed")
    return world.with_fixture(name, on=frozenset())


def came_true(world: WorldState, process: Process, name: str) -> bool:
    """Whether it is so in this world what a process comes to."""
    if process.does == "mark":
        return process.mark in world.objects[name].marks
    return world.fixtures[name].door == "closed" if process.does == "shut" else not world.fixtures[name].on


def spoilt(rules: Rules, world: WorldState, names: Iterable[str]) -> bool:
    """Whether any of these objects is lost."""
    marks = {process.mark for process in rules.processes if process.spoils}
    return any(marks & world.objects[name].marks for name in names if name in world.objects)
