"""Quirks, a row each: facts about one kitchen that no sentence tells and no common sense can guess.

A kitchen has those of `Rules.quirks`, each a `Quirk(kind, about, other)`. Checking finds them: after the command a
condition is false that should be true. Whoever has found one can do something about it: see `remedy`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from remac_env.errors import check_choice
from remac_env.frozen import FrozenMap
from remac_env.rules import subjects
from remac_env.rules.facts import ASIDE, Quirk, Rules
from remac_env.rules.marks import WASHED
from remac_env.rules.outcomes import Outcome, failure
from remac_env.rules.places import landing, switch_for, unshut
from remac_env.rules.predicates import PREDICATES
from remac_env.rules.subtasks import Subtask
from remac_env.rules.tables import by_name
from remac_env.state import WorldState, base_place, contents

LOOSENED = "loosened"
"""The mark of what stuck and has been pulled at."""

Hinders = Callable[[Quirk, Rules, WorldState, str, Subtask], bool]
"""Whether it keeps a robot's subtask from succeeding, seen from the world before the round."""

Changes = Callable[[Quirk, Rules, WorldState, Subtask], WorldState]
"""What is true besides, given the world after a subtask; for one that was kept from succeeding, after nothing."""

Drifts = Callable[[Quirk, Rules, WorldState], WorldState]
"""What becomes of a world at rest by itself."""

Draws = Callable[[Rules], Iterator[tuple[str, str]]]
"""What a quirk of this kind can be about in a kitchen: (about, other)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class QuirkKind:
    """One row.

    Attributes:
        name: what tasks and records call it.
        sentence: it in words, with {0} for what it is about and {1} for the other; told to nobody who plays.
        shows: the predicate that is found false where it has its way.
        looks: what a camera shows then.
        remedy: what can be done about it.
        draws: what it can be about.
        hinders, spoils, changes, drifts: what it does; None for nothing. `spoils` is how the world changes where it
            hinders, `changes` where the subtask succeeds.
        team: no robot alone can do anything about it.
        marks_alone: it takes marks from objects and does nothing else; in physics too it is these rules that do it.
        fills, stains: how what it is about looks from the start: full up to the front, or with stains in it.
        across: it is a floor plan: what stands on the other can also be used from where it is about. Anybody may know
            that; no layout of physics has it.
    """

    name: str
    sentence: str
    shows: str
    looks: str
    remedy: str
    draws: Draws
    hinders: Hinders | None = None
    spoils: Changes | None = None
    changes: Changes | None = None
    drifts: Drifts | None = None
    team: bool = False
    marks_alone: bool = False
    fills: bool = False
    stains: bool = False
    across: bool = False

    def __post_init__(self) -> None:
        """Refuse a row that shows in no condition."""
        check_choice(f"quirk {self.name!r}: shows", self.shows, PREDICATES)


# -- who is where ---------------------------------------------------------------------------------------------------


def _attended(rules: Rules, world: WorldState, fixture: str, *, but: str = "") -> bool:
    """Whether a robot (but one) stands where a fixture is used."""
    there = rules.stations_of(fixture)
    return any(state.station in there for name, state in world.robots.items() if name != but)


def _turns_on(quirk: Quirk, subtask: Subtask) -> bool:
    return subtask.skill == "turn on" and subtask.target == quirk.about


# -- what they do ---------------------------------------------------------------------------------------------------


def _cold(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    facts = rules.fixtures.get(subtask.target)
    of_it = facts is not None and subtask.skill == "turn on" and quirk.about in facts.switches
    return of_it and switch_for(rules, world, subtask.target) == quirk.about


def _jams(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    shut = subtask.target == quirk.about and world.fixtures[quirk.about].door == "closed"
    return shut and subtask.skill == "open door"


def _gives_way(quirk: Quirk, rules: Rules, world: WorldState, subtask: Subtask) -> WorldState:
    return unshut(rules, world, quirk.about, "ajar")


def _falls_shut(quirk: Quirk, rules: Rules, world: WorldState) -> WorldState:
    left = world.fixtures[quirk.about].door != "closed" and not _attended(rules, world, quirk.about)
    return world.with_fixture(quirk.about, door="closed") if left else world


def _swings_open(quirk: Quirk, rules: Rules, world: WorldState) -> WorldState:
    left = world.fixtures[quirk.about].door == "closed" and not _attended(rules, world, quirk.about)
    return unshut(rules, world, quirk.about, "ajar") if left else world


def _goes_off(quirk: Quirk, rules: Rules, world: WorldState) -> WorldState:
    left = world.fixtures[quirk.about].on and not _attended(rules, world, quirk.about)
    return world.with_fixture(quirk.about, on=frozenset()) if left else world


def _other_is_off(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    return _turns_on(quirk, subtask) and not world.fixtures[quirk.other].on


def _other_is_open(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    return _turns_on(quirk, subtask) and world.fixtures[quirk.other].door != "closed"


def _other_is_left(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    return _turns_on(quirk, subtask) and not _attended(rules, world, quirk.other, but=robot)


def _other_goes_off(quirk: Quirk, rules: Rules, world: WorldState, subtask: Subtask) -> WorldState:
    return world.with_fixture(quirk.other, on=frozenset()) if _turns_on(quirk, subtask) else world


def _is_full(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    if not subtask.row.puts or subtask.target != quirk.about:
        return False
    place = landing(rules, world, robot, subtask.target)
    return place is not None and place.relation == "slot"


def _is_hot(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    if not subtask.row.takes:
        return False
    return base_place(world, subtask.target).where in world.fixtures[quirk.about].on


def _sticks(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    loose = LOOSENED in world.objects[quirk.about].marks
    return subtask.row.takes and subtask.target == quirk.about and not loose


def _comes_loose(quirk: Quirk, rules: Rules, world: WorldState, subtask: Subtask) -> WorldState:
    return world.with_object(quirk.about, marks=world.objects[quirk.about].marks | {LOOSENED})


def _no_way(quirk: Quirk, rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> bool:
    here, leads = world.robots[robot].station, subtask.row.goes
    if leads is None or here == ASIDE:
        return False
    goal, far = leads(rules, world, robot, subtask.target), rules.fixtures[quirk.about].station
    return goal != here and (goal == ASIDE or (goal == far) != (here == far))


def _soils(quirk: Quirk, rules: Rules, world: WorldState) -> WorldState:
    if WASHED in world.objects[quirk.about].marks:
        return world
    for name in contents(world, quirk.about):
        if WASHED in (marks := world.objects[name].marks):
            world = world.with_object(name, marks=marks - {WASHED})
    return world


# -- the rows -------------------------------------------------------------------------------------------------------

QUIRKS: dict[str, QuirkKind] = by_name("quirk", "sentence", (
    QuirkKind(name="jammed door", sentence="the {0} door jams: the first pull only brings it ajar", shows="door_open",
              looks="the door stands ajar", remedy="pull again", draws=subjects.doors,
              hinders=_jams, spoils=_gives_way),
    QuirkKind(name="stuck object", sentence="the {0} sticks to what it stands on: the first pull only loosens it",
              shows="holding", looks="it is still where it was", remedy="pick it up again", draws=subjects.objects,
              hinders=_sticks, spoils=_comes_loose),
    QuirkKind(name="cold burner", sentence="{0} stays cold", shows="switched_on", looks="no flame",
              remedy="use another burner: put something else on this one first", draws=subjects.burners, hinders=_cold),
    QuirkKind(name="dead switch", sentence="the {0} has no power", shows="switched_on", looks="no light, no flame",
              remedy="use another fixture that does the same", draws=subjects.switches,
              hinders=lambda quirk, rules, world, robot, subtask: _turns_on(quirk, subtask)),
    QuirkKind(name="enabling switch", sentence="the {0} only comes on while the {1} is on", shows="switched_on",
              looks="no light, no flame", remedy="turn on the other one first", draws=subjects.switch_pairs,
              hinders=_other_is_off),
    QuirkKind(name="guard door", sentence="the {0} only comes on while the {1} door is shut", shows="switched_on",
              looks="no light, no flame, and a door that is open", remedy="shut that door first",
              draws=subjects.switch_and_door, hinders=_other_is_open),
    QuirkKind(name="fuse", sentence="turning on the {0} turns off the {1}", shows="switched_on",
              looks="the other one has gone out", remedy="turn it on again, or be done with it before",
              draws=subjects.switch_pairs, changes=_other_goes_off),
    QuirkKind(name="spring switch", sentence="the {0} goes off when nobody stands there", shows="switched_on",
              looks="it has gone out", remedy="stay there while it has to be on",
              draws=subjects.switches, drifts=_goes_off),
    QuirkKind(name="falling door", sentence="the {0} door falls shut when nobody stands there", shows="accessible",
              looks="the door is shut again", remedy="let another robot hold it", draws=subjects.doors,
              drifts=_falls_shut, team=True),
    QuirkKind(name="swinging door", sentence="the {0} door comes open when nobody stands there", shows="door_closed",
              looks="the door stands ajar", remedy="shut it last, and stay there",
              draws=subjects.doors, drifts=_swings_open),
    QuirkKind(name="full shelf", sentence="the {0} is full up to the front", shows="inside",
              looks="things close behind the door", remedy="use another place", draws=subjects.stores, hinders=_is_full,
              fills=True),
    QuirkKind(name="hot vessel", sentence="what stands on the {0} cannot be held while it is on", shows="holding",
              looks="it is still where it was, over a flame", remedy="turn it off first", draws=subjects.ranges,
              hinders=_is_hot),
    QuirkKind(name="dirty vessel", sentence="the {0} is dirty: what is washed does not stay so in it", shows="marked",
              looks="stains in it", remedy="wash it too, or use another vessel", draws=subjects.vessels, drifts=_soils,
              marks_alone=True, stains=True),
    QuirkKind(name="two hands", sentence="the {0} only comes on while another robot stands at the {1}",
              shows="switched_on", looks="no light, no flame", remedy="let another robot stand there",
              draws=subjects.distant_switches, hinders=_other_is_left, team=True),
    QuirkKind(name="narrow galley", shows="at", looks="it stands where it stood", draws=subjects.worktops,
              hinders=_no_way, team=True, across=True,
              sentence="nobody gets past the {1}: who came in on one side stays there, and the {0} is on the other",
              remedy="let another robot go to the far side, and pass things over"),
))  # fmt: skip
"""Every kind of quirk by name."""


def sentence_of(quirk: Quirk) -> str:
    """The quirk in plain English."""
    return QUIRKS[quirk.kind].sentence.format(quirk.about, quirk.other)


def laid_out(rules: Rules) -> Rules:
    """The kitchen with what can be used from two sides where its quirks are floor plans."""
    for quirk in (quirk for quirk in rules.quirks if QUIRKS[quirk.kind].across):
        beyond = rules.fixtures[quirk.about].station
        slots = {name: replace(rules.slots[name], across=beyond) for name in rules.fixtures[quirk.other].slots}
        rules = replace(rules, slots=FrozenMap({**rules.slots, **slots}))
    return rules


def hindered(rules: Rules, world: WorldState, robot: str, subtask: Subtask) -> tuple[Outcome, WorldState] | None:
    """How a subtask ends that a quirk keeps from succeeding, and the world after it; None where none does."""
    for quirk in rules.quirks:
        row = QUIRKS[quirk.kind]
        if row.hinders is not None and row.hinders(quirk, rules, world, robot, subtask):
            after = world if row.spoils is None else row.spoils(quirk, rules, world, subtask)
            return HINDERED, after
    return None


HINDERED = failure("blocked", "it was tried, and did not come about")
"""What robots are told: not why."""


def changed(rules: Rules, world: WorldState, subtask: Subtask) -> WorldState:
    """The world after a subtask that succeeded, with what quirks change besides."""
    for quirk in rules.quirks:
        if (change := QUIRKS[quirk.kind].changes) is not None:
            world = change(quirk, rules, world, subtask)
    return world


def drifted(rules: Rules, world: WorldState) -> WorldState:
    """A world at rest with what quirks bring about by themselves."""
    for quirk in rules.quirks:
        if (drift := QUIRKS[quirk.kind].drifts) is not None:
            world = drift(quirk, rules, world)
    return world
