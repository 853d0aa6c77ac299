"""begin and advance in both backends: who is refused, when each ends, and that a round is nothing but these."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import replace
from random import Random

import pytest

from remac_env.backends.base import Backend
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.multi_robot import MultiRobotPlanner
from remac_env.backends.symbolic import SymbolicBackend
from remac_env.errors import LifecycleError, UnknownNameError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.rules.claims import Claim, settle_claims
from remac_env.rules.marks import washed
from remac_env.rules.outcomes import Outcome
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import STEP_ASIDE, WAIT, Subtask
from remac_env.start import Offset, Start
from remac_env.state import FrozenMap, ObjectState, Place, RobotState, WorldState
from remac_env.testing import ContractError
from remac_env.testing.world import check_world

A, B = "robot_0", "robot_1"
BACKENDS: tuple[Callable[[], Backend], ...] = (SymbolicBackend, PhysicsBackend)


def to(target: str) -> Subtask:
    return Subtask("navigate to", target)


def make_start() -> Start:
    layout, category = layouts.load("one_wall_large"), catalogue.get("carrot")
    scene = build_scene(layout, {"vegetable": category}, (A, B))
    world = WorldState(
        FrozenMap({A: RobotState(), B: RobotState()}),
        FrozenMap({"vegetable": ObjectState(Place("slot", "counter.1"))}),
        resting_fixtures(scene),
    )
    return Start(
        scene=scene, world=world, layout=layout.name, style="coastal", categories={"vegetable": "carrot"},
        offsets={"vegetable": Offset()}, robots={A: (0, Offset()), B: (1, Offset())}, doors={}, seed=3,
    )  # fmt: skip


def check_events(backend: Backend) -> None:
    """What every backend keeps to, in one short course of two robots."""
    with pytest.raises(LifecycleError, match="reset"):
        backend.begin({A: WAIT})
    backend.reset(make_start())
    assert backend.advance() == {} and backend.busy == frozenset()
    with pytest.raises(UnknownNameError, match="robot_9.*robot_0, robot_1"):
        backend.begin({A: to("sink"), "robot_9": WAIT})
    assert backend.busy == frozenset(), "nothing begins of what is refused with an error"

    assert backend.begin({A: to("sink")}) == {} and backend.busy == {A}
    with pytest.raises(LifecycleError, match=r"robot_0 is busy.*robot_1"):
        backend.begin({A: WAIT})
    with pytest.raises(LifecycleError, match=r"robot_0 is busy"):
        backend.run_round({A: WAIT, B: WAIT})
    # A has not come to the sink yet, and the sink is A's already.
    (refused,) = backend.begin({B: to("faucet")}).values()
    assert (refused.reason, refused.refused, refused.seconds) == ("station_occupied", True, 0.0)
    assert backend.begin({B: WAIT}) == {}
    waited = backend.advance()[B]
    assert waited.success and (waited.began, waited.ended) == (0.0, 0.0) and backend.busy == {A}
    arrived = backend.advance()
    assert set(arrived) == {A} and arrived[A].success and backend.busy == frozenset()
    check_times(arrived[A], began=0.0)
    assert backend.world.robots[A].station == "sink"

    # Where A began is A's until it has ended; then it is free.
    assert backend.begin({A: STEP_ASIDE}) == {}
    assert backend.begin({B: to("sink")})[B].reason == "station_occupied"
    gone = backend.advance()[A]
    assert gone.success and gone.began >= arrived[A].ended
    assert backend.begin({B: to("sink")}) == {}
    assert backend.advance()[B].success and backend.world.robots[B].station == "sink"


def check_times(outcome: Outcome, *, began: float) -> None:
    assert outcome.began == began and outcome.seconds > 0.0
    assert outcome.ended - outcome.began == pytest.approx(outcome.seconds, abs=0.02)


@pytest.mark.parametrize("make", BACKENDS)
def test_a_backend_begins_and_advances(make: Callable[[], Backend]) -> None:
    check_events(make())


class ForgetsWhoIsBusy(SymbolicBackend):
    """Claims end with the call that made them."""

    def begin(self, subtasks: Mapping[str, Subtask]) -> dict[str, Outcome]:
        busy, self._running = self._running, {}
        try:
            return super().begin(subtasks)
        finally:
            self._running = busy | self._running


class RunsToTheLastEnd(SymbolicBackend):
    def advance(self) -> dict[str, Outcome]:
        ended: dict[str, Outcome] = {}
        while self.busy:
            ended |= super().advance()
        return ended


class TellsAllAtOnce(SymbolicBackend):
    def begin(self, subtasks: Mapping[str, Subtask]) -> dict[str, Outcome]:
        return super().begin(subtasks) | {robot: run.outcome for robot, run in self._running.items()}


class HasNoClock(SymbolicBackend):
    def _timed(self, outcome: Outcome, subtask: Subtask) -> Outcome:
        self._clock = 0.0
        return super()._timed(outcome, subtask)


@pytest.mark.parametrize("make", [ForgetsWhoIsBusy, RunsToTheLastEnd, TellsAllAtOnce, HasNoClock])
def test_a_wrong_backend_is_found_out(make: Callable[[], Backend]) -> None:
    with pytest.raises((AssertionError, pytest.fail.Exception)):
        check_events(make())


@pytest.mark.parametrize("make", BACKENDS)
def test_begun_and_advanced_together_is_a_round(make: Callable[[], Backend]) -> None:
    by_round, by_events = make(), make()
    by_round.reset(make_start())
    by_events.reset(make_start())
    for joint in ({A: to("vegetable"), B: to("stove")}, {A: Subtask("pick up", "vegetable"), B: to("vegetable")}):
        told = by_round.run_round(joint)
        found = dict(by_events.begin(joint))
        while by_events.busy:
            found |= by_events.advance()
        assert found == told.outcomes and by_events.world == told.world
        one, other = by_round.positions(), by_events.positions()
        assert (one is None and other is None) or (one == other).all()  # type: ignore[union-attr]


def test_any_rounds_by_the_table_are_the_same_by_events() -> None:
    by_round, by_events, chance = SymbolicBackend(failure_rate=0.2), SymbolicBackend(failure_rate=0.2), Random(5)
    targets = ("cabinet", "sink", "stove", "faucet", "microwave", "vegetable")
    commands = [Subtask(skill, target) for skill in SKILLS if skill.endswith("to") for target in targets]
    commands += [WAIT, STEP_ASIDE, Subtask("turn on", "faucet"), Subtask("pick up", "vegetable")]
    commands += [Subtask("open door", "cabinet"), Subtask("close door", "cabinet")]
    for backend in (by_round, by_events):
        backend.reset(make_start())
    for _ in range(400):
        joint = {A: chance.choice(commands), B: chance.choice(commands)}
        told, found = by_round.run_round(joint), by_events.begin(joint)
        while by_events.busy:
            found |= by_events._next()  # as a round does, which has no rests between
        by_events._world = washed(make_start().scene, by_events.world)
        assert found == told.outcomes and by_events.world == told.world


def test_effects_come_true_one_by_one_and_effects_that_contradict_are_refused() -> None:
    backend = SymbolicBackend()
    backend.reset(make_start())
    backend.run_round({A: to("vegetable"), B: to("cabinet")})
    backend.begin({A: Subtask("pick up", "vegetable"), B: Subtask("open door", "cabinet")})
    assert set(backend.advance()) == {A}
    assert (backend.world.robots[A].holding, backend.world.fixtures["cabinet"].door) == ("vegetable", "closed")
    copied = copy.deepcopy(backend)
    assert set(backend.advance()) == {B} and backend.world.fixtures["cabinet"].door == "open"
    assert copied.busy == {B} and copied.advance()[B].ended == SKILLS["navigate to"].seconds + 9.0


def test_what_a_busy_robot_takes_is_taken() -> None:
    """Nothing lets two robots stand at one station; the rule holds all the same."""
    start = make_start()
    world = start.world.with_robot(B, station="counter_mid")
    claims = {A: Claim("counter_mid", "counter_mid", "vegetable")}
    refused, _ = settle_claims(start.scene, world, {B: Subtask("pick up", "vegetable")}, claims)
    assert refused[B].reason == "station_occupied" and refused[B].refused
    assert settle_claims(start.scene, world, {B: Subtask("pick up", "vegetable")})[0] == {}


def two_sided() -> Start:
    """The first place on the counter can be used from the sink too; something lies on it, and something in the sink."""
    start, category = make_start(), catalogue.get("carrot")
    names = {"vegetable": "counter.0", "fruit": "sink.0"}
    scene = build_scene(layouts.load("one_wall_large"), dict.fromkeys(names, category), (A, B))
    slots = scene.slots.with_("counter.0", replace(scene.slots["counter.0"], across="sink"))
    lying = FrozenMap({name: ObjectState(Place("slot", slot)) for name, slot in names.items()})
    return replace(
        start, scene=replace(scene, slots=slots), world=replace(start.world, objects=lying),
        categories=dict.fromkeys(names, "carrot"), offsets=dict.fromkeys(names, Offset()),
    )  # fmt: skip


def both_put_down(backend: Backend) -> tuple[Outcome, Outcome]:
    """Who sets something down second in the place where another one does: while that goes on, and afterwards."""
    start, put = two_sided(), Subtask("place to", "counter")
    backend.reset(start)
    backend.run_round({A: to("counter"), B: to("sink")})
    picked = backend.run_round({A: Subtask("pick up", "vegetable"), B: Subtask("pick up", "fruit")})
    assert all(outcome.success for outcome in picked.outcomes.values())
    assert backend.begin({A: put}) == {}
    refused = backend.begin({B: put}).get(B)
    while backend.busy:
        ended = backend.advance()
        check_world(start.scene, backend.world)
    assert ended[A].success and backend.world.objects["vegetable"].place == Place("slot", "counter.0")
    backend.begin({B: put})
    (later,) = backend.advance().values()
    assert refused is not None
    return refused, later


@pytest.mark.parametrize("make", [SymbolicBackend, pytest.param(PhysicsBackend, marks=pytest.mark.long)])
def test_a_place_is_taken_from_when_one_begins_to_put_something_there(make: Callable[[], Backend]) -> None:
    refused, later = both_put_down(make())
    assert (refused.reason, refused.refused) == ("station_occupied", True)
    assert (later.reason, later.refused) == ("blocked", False), "it is free again, and full"


def test_places_that_nobody_claims_hold_two_things(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("remac_env.rules.claims.landing", lambda *told: None)
    with pytest.raises(ContractError, match="in one slot 'counter.0'"):
        both_put_down(SymbolicBackend())


@pytest.mark.parametrize(
    ("mine", "theirs", "reason"),
    [
        ("place to plate", Claim("sink", "sink", "plate"), "station_occupied"),
        ("pick up plate", Claim("sink", "sink", None, Place("vessel", "plate")), "station_occupied"),
        ("place to plate", Claim("sink", "sink", None, Place("vessel", "plate")), "station_occupied"),
        ("place to plate", Claim("sink", "sink", None, Place("slot", "counter.1")), None),
        ("place to plate", Claim("sink", "sink", "fruit"), None),
    ],
)
def test_a_vessel_is_not_taken_away_or_filled_twice(mine: str, theirs: Claim, reason: str | None) -> None:
    kinds = {"plate": catalogue.get("plate"), "vegetable": catalogue.get("carrot")}
    start, scene = two_sided(), build_scene(layouts.load("one_wall_large"), kinds, (A, B))
    scene = replace(scene, slots=start.scene.slots)
    objects = {"plate": ObjectState(Place("slot", "counter.0")), "vegetable": ObjectState(Place("slot", "counter.1"))}
    world = replace(start.world, objects=FrozenMap(objects)).with_robot(A, station="counter_mid")
    if mine.startswith("place"):
        world = world.with_object("vegetable", place=Place("held", A)).with_robot(A, holding="vegetable")
    (skill, target) = mine.rsplit(" ", 1)
    refused, _ = settle_claims(scene, world, {A: Subtask(skill, target)}, {B: theirs})
    assert refused == {} if reason is None else (refused[A].reason, refused[A].refused) == (reason, True)


def crossing(backend: PhysicsBackend) -> dict[str, Outcome]:
    """One robot goes from the fridge to the microwave; when it is on its way another would go aside through it."""
    backend.reset(make_start())
    backend.run_round({A: to("fridge"), B: to("sink")})
    assert backend.begin({A: to("microwave")}) == backend.begin({B: to("vegetable")}) == {}
    assert set(backend.advance()) == {B} and backend.busy == {A}
    assert backend.begin({B: STEP_ASIDE}) == {}
    copied, ended = copy.deepcopy(backend), dict[str, Outcome]()
    while backend.busy:
        ended |= backend.advance()
    while copied.busy:
        copied.advance()
    assert (backend.positions() == copied.positions()).all() and backend.world == copied.world
    return ended


def test_a_drive_that_begins_later_keeps_clear_of_one_under_way() -> None:
    backend = PhysicsBackend()
    ended = crossing(backend)
    assert {robot: outcome.reason for robot, outcome in ended.items()} == {A: None, B: None}
    assert ended[A].began < ended[B].began < ended[A].ended, "the second began while the first drove"
    assert backend.counters.near_misses == backend.counters.robot_contacts == 0


def test_a_drive_that_does_not_know_of_one_under_way_meets_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MultiRobotPlanner, "under_way", lambda self: iter(()))
    backend = PhysicsBackend()
    ended = crossing(backend)
    assert backend.counters.robot_contacts > 0 and not all(outcome.success for outcome in ended.values())
