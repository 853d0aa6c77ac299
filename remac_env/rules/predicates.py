"""The predicates, a row each: all that is known of one stands on its row, and nowhere else.

From the rows come the sentences and their parser, the test on the truth, what a checker answers from and what an
adjuster does about it. Docs: docs/extending.md, "add a predicate".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from string import Formatter
from typing import Literal

from remac_env.errors import OptionError, check_choice
from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.places import destination, kind_around, landing, stations_of, switch_for
from remac_env.rules.scene import NAME_KINDS, NameKind
from remac_env.rules.tables import by_name
from remac_env.state import Place, WorldState, base_place, contents, inside, supports

Kind = Literal["seen", "felt", "known", "ran"]
"""What an answer comes from: see `Predicate`."""

KINDS: tuple[str, ...] = Kind.__args__  # type: ignore[attr-defined]
"""All of them."""

Test = Callable[..., bool]
"""(rules, world, *arguments) -> whether it is true."""

Feel = Callable[..., bool]
"""(shakers, what the robot holds, *arguments) -> what it feels."""

ArgumentKind = NameKind | Literal["mark"]
"""One of ABOUT."""

ABOUT: tuple[str, ...] = (*NAME_KINDS, "mark")
"""What an argument can be: a kind of name, or what has happened to an object."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Predicate:
    """One row.

    Attributes:
        name: what conditions, records and requirements call it.
        about: the kind of each argument, one or more of ABOUT.
        sentence: it in words, with {0} for the first argument.
        test: whether it is true, from (rules, world, *arguments).
        kind: what an answer comes from: pictures ("seen"), a robot's own gripper ("felt"), knowledge of a rule
            ("known"; no picture shows what is right or possible), or what was run ("ran"; nothing is left to see).
        feel: of the kind "felt", whose first argument is a robot: the answer from (shakers, what the robot holds,
            *other arguments), where shakers are the names of objects that season.
        repair: what makes it true again, by its name in `remac_agents.adjusters.rule.REPAIRS`; "achieve" is any skill
            that achieves it; None where no rule helps.
        settled: it hangs on where the other robots go in the same round, so that the round itself decides it.
        fixtures_always: it is true of every fixture, so that nobody need look.
        false_if_held: it is false of an object in a gripper, whatever else is true of that.
        denies: the predicate of the same arguments that is true wherever it is false, if there is one.
    """

    name: str
    about: tuple[ArgumentKind, ...]
    sentence: str
    test: Test
    kind: Kind = "seen"
    feel: Feel | None = None
    repair: str | None = None
    settled: bool = False
    fixtures_always: bool = False
    false_if_held: bool = False
    denies: str | None = None

    def __post_init__(self) -> None:
        """Refuse a row that lacks a part or contradicts itself."""
        where = f"predicate {self.name!r}"
        if not self.name.isidentifier():
            raise OptionError(f"{where}: the name is not valid; valid: a word of letters, digits and underscores")
        if not self.about:
            raise OptionError(f"{where}: about names no argument; valid: one or more of {', '.join(ABOUT)}")
        for kind in self.about:
            check_choice(f"{where}: about", kind, ABOUT)
        check_choice(f"{where}: kind", self.kind, KINDS)
        used = {field for _, field, _, _ in Formatter().parse(self.sentence) if field is not None}
        if used != {str(number) for number in range(len(self.about))}:
            wanted = " and ".join(f"{{{number}}}" for number in range(len(self.about)))
            raise OptionError(f"{where}: sentence {self.sentence!r} does not say all arguments; valid: with {wanted}")
        if (self.kind == "felt") != (self.feel is not None) or (self.feel is not None and self.about[0] != "robot"):
            given = f"kind {self.kind!r} with feel={self.feel!r} about {', '.join(self.about)}"
            raise OptionError(f"{where}: {given}; valid: a feel and a robot first for felt, no feel for other kinds")


# -- what decides them ----------------------------------------------------------------------------------------------


def _at(rules: Rules, world: WorldState, robot: str, target: str) -> bool:
    return world.robots[robot].station in stations_of(rules, world, target)


def _station_free(rules: Rules, world: WorldState, robot: str, target: str) -> bool:
    goal = destination(rules, world, robot, target)
    others = (state.station for name, state in world.robots.items() if name != robot)
    return goal is not None and not any(rules.conflicting(goal, other) for other in others)


def _accessible(rules: Rules, world: WorldState, target: str) -> bool:
    around = [target] if target in rules.fixtures else supports(rules, world, target)
    doors = (world.fixtures[name].door for name in around if name in rules.fixtures)
    return all(door in (None, "open") for door in doors)


def _placed(rules: Rules, world: WorldState, target: str) -> bool:
    return target in rules.fixtures or base_place(world, target).relation == "slot"


def _graspable(rules: Rules, world: WorldState, target: str) -> bool:
    kind, place = kind_around(rules, world, target), world.objects[target].place
    deep = place.relation == "vessel" and kind in rules.objects[place.where].too_deep_in
    return not deep and kind not in rules.objects[target].too_big_for


def _room(rules: Rules, world: WorldState, robot: str, target: str) -> bool:
    return landing(rules, world, robot, target) is not None


def _no_vessel_needed(rules: Rules, world: WorldState, robot: str, target: str) -> bool:
    held = world.robots[robot].holding
    if held is None or target not in rules.fixtures:
        return True
    place = landing(rules, world, robot, target)
    if place is not None and place.relation == "vessel":
        return True
    return rules.fixtures[target].kind not in rules.objects[held].needs_vessel_in


def _switched_on(rules: Rules, world: WorldState, fixture: str) -> bool:
    return switch_for(rules, world, fixture) in world.fixtures[fixture].on


def _may_run(rules: Rules, world: WorldState, fixture: str) -> bool:
    return not rules.fixtures[fixture].shut_to_run or world.fixtures[fixture].door == "closed"


def _all_off(rules: Rules, world: WorldState, fixture: str) -> bool:
    return not world.fixtures[fixture].on


def _within(rules: Rules, world: WorldState, name: str, container: str) -> bool:
    return inside(rules, world, name, container)


def _by_gripper(feel: Feel) -> Test:
    return lambda rules, world, robot, *others: feel(rules.shakers, world.robots[robot].holding, *others)


def _felt(
    name: str, about: tuple[ArgumentKind, ...], sentence: str, feel: Feel, *, repair: str | None = None
) -> Predicate:
    """A row whose truth is what the gripper feels."""
    return Predicate(
        name=name, about=about, sentence=sentence, test=_by_gripper(feel), kind="felt", feel=feel, repair=repair
    )


def _door(
    name: str, sentence: str, test: Callable[[str | None], bool], *,
    repair: str | None = None, denies: str | None = None,
) -> Predicate:  # fmt: skip
    """A row about the state of a fixture's door."""
    decided: Test = lambda rules, world, fixture: test(world.fixtures[fixture].door)
    return Predicate(name=name, about=("door",), sentence=sentence, test=decided, repair=repair, denies=denies)


# -- the rows -------------------------------------------------------------------------------------------------------

PREDICATES: dict[str, Predicate] = by_name("predicate", "sentence", (
    Predicate(
        name="at", about=("robot", "thing"), test=_at,
        sentence="{0} stands at the {1}", repair="go there",
    ),
    Predicate(
        name="aside", about=("robot",), test=lambda rules, world, robot: world.robots[robot].station == ASIDE,
        sentence="{0} has stepped aside",
    ),
    Predicate(
        name="station_free", about=("robot", "thing"), test=_station_free,
        sentence="no other robot stands where {0} needs to be for the {1}", settled=True,
    ),
    _felt("hand_empty", ("robot",), "the gripper of {0} is empty",
          lambda shakers, held: held is None, repair="put down"),
    _felt("holding", ("robot", "object"), "the gripper of {0} holds the {1}",
          lambda shakers, held, name: held == name),
    _felt("hand_full", ("robot",), "the gripper of {0} holds something",
          lambda shakers, held: held is not None, repair="fetch again"),
    _felt("holds_shaker", ("robot",), "the gripper of {0} holds a shaker",
          lambda shakers, held: held in shakers, repair="fetch a shaker"),
    Predicate(
        name="placed", about=("thing",), test=_placed,
        sentence="the {0} is in its place: neither in a gripper nor on the floor",
        repair="leave out if held", fixtures_always=True, false_if_held=True,
    ),
    Predicate(
        name="accessible", about=("thing",), test=_accessible,
        sentence="no shut door is in front of the {0}", repair="open the door",
    ),
    Predicate(
        name="unloaded", about=("object",), test=lambda rules, world, name: not contents(world, name),
        sentence="nothing lies on or in the {0}", repair="unload",
    ),
    Predicate(
        name="graspable", about=("object",), test=_graspable, kind="known",
        sentence="the gripper has room to take hold of the {0} where it is",
    ),
    Predicate(
        name="room", about=("robot", "thing"), test=_room,
        sentence="the {1} has room for what {0} holds", repair="make room",
    ),
    Predicate(
        name="no_vessel_needed", about=("robot", "thing"), test=_no_vessel_needed, kind="known",
        sentence="what {0} holds may touch the {1} without a vessel", repair="use a vessel",
    ),
    Predicate(
        name="inside", about=("object", "thing"), test=inside,
        sentence="the {0} is on or in the {1}", false_if_held=True,
    ),
    Predicate(
        name="directly_on", about=("object", "vessel"),
        test=lambda rules, world, name, vessel: world.objects[name].place == Place("vessel", vessel),
        sentence="the {0} lies on or in the {1} itself", false_if_held=True,
    ),
    _door("door_open", "the {0} door is open", lambda door: door == "open"),
    _door("door_not_open", "the {0} door is not open yet", lambda door: door != "open", repair="leave out",
          denies="door_open"),
    _door("door_closed", "the {0} door is closed", lambda door: door == "closed"),
    _door("door_not_closed", "the {0} door is not closed yet", lambda door: door != "closed", repair="leave out",
          denies="door_closed"),
    Predicate(
        name="switched_on", about=("switch",), test=_switched_on,
        sentence="the {0} is switched on",
    ),
    Predicate(
        name="switched_off", about=("switch",),
        test=lambda rules, world, fixture: not _switched_on(rules, world, fixture),
        sentence="the {0} is not switched on yet", repair="leave out", denies="switched_on",
    ),
    Predicate(
        name="some_on", about=("switch",), test=lambda rules, world, fixture: not _all_off(rules, world, fixture),
        sentence="the {0} is not switched off yet", repair="leave out",
    ),
    Predicate(
        name="all_off", about=("switch",), test=_all_off,
        sentence="the {0} is switched off", denies="some_on",
    ),
    Predicate(
        name="may_run", about=("fixture",), test=_may_run,
        sentence="nothing keeps the {0} from running", repair="shut the door",
    ),
    Predicate(
        name="marked", about=("object", "mark"), kind="ran",
        test=lambda rules, world, name, mark: mark in world.objects[name].marks,
        sentence="the {0} has been {1}",
    ),
))  # fmt: skip
"""Every predicate by name, in the order in which their sentences are told."""
