"""Rounds in MuJoCo: determinism, outcomes of the table's hard cases, and traffic."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.errors import LifecycleError
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.rules.subtasks import Subtask
from remac_env.start import Offset, Start
from remac_env.state import FrozenMap, ObjectState, Place, RobotState, WorldState

WAIT = Subtask("wait")


def make_start(
    places: Mapping[str, tuple[str, Place]], *, robots: tuple[str, ...] = ("robot_0",), doors: Mapping[str, float] = {},
    seed: int = 3,
) -> Start:
    """A start with objects (noun -> category and place) and doors at angles."""
    layout = layouts.load("one_wall_large")
    things = {noun: catalogue.get(category) for noun, (category, _) in places.items()}
    scene = build_scene(layout, things, robots)
    fixtures = resting_fixtures(scene)
    for name, angle in doors.items():
        state = "open" if angle >= 0.9 else "ajar" if angle > 0.05 else "closed"
        fixtures = fixtures.with_(name, type(fixtures[name])(state))
    world = WorldState(
        FrozenMap({name: RobotState() for name in robots}),
        FrozenMap({noun: ObjectState(place) for noun, (_, place) in places.items()}),
        fixtures,
    )
    return Start(
        scene=scene, world=world, layout=layout.name, style="coastal",
        categories={noun: category for noun, (category, _) in places.items()},
        offsets={noun: Offset(0.01, -0.02, 0.4) for noun in places},
        robots={name: (index, Offset()) for index, name in enumerate(robots)}, doors=doors, seed=seed,
    )


CARROT = {"vegetable": ("carrot", Place("slot", "counter.1"))}


def run(backend: PhysicsBackend, *commands: tuple[str, str], robot: str = "robot_0") -> list[str | None]:
    """Reasons of the outcomes of commands run one after the other, None for successes."""
    reasons = []
    for skill, target in commands:
        outcome = backend.run_round({robot: Subtask(skill, target)}).outcomes[robot]
        reasons.append(outcome.reason)
    return reasons


def test_reset_shows_the_start() -> None:
    start = make_start(
        {
            "vegetable": ("potato", Place("vessel", "plate")), "plate": ("plate", Place("slot", "cabinet.0")),
            "bowl": ("bowl", Place("slot", "sink.0")), "pan": ("pan", Place("slot", "stove.1")),
        },
        robots=("robot_0", "robot_1"), doors={"cabinet": 0.5, "microwave": 1.3},
    )
    assert PhysicsBackend().reset(start) == start.world


def test_same_start_same_run_whatever_came_before() -> None:
    start = make_start(CARROT)
    commands = (("navigate to", "vegetable"), ("pick up", "vegetable"), ("navigate to", "stove"))
    fresh, used = PhysicsBackend(), PhysicsBackend()
    used.reset(make_start({"vegetable": ("potato", Place("slot", "counter.4"))}, seed=9))
    run(used, ("navigate to", "vegetable"))
    finals = []
    for backend in (fresh, used, used):
        backend.reset(start)
        assert run(backend, *commands) == [None, None, None]
        finals.append(np.concatenate([backend.data.qpos, backend.data.qvel, backend.data.act]))
    np.testing.assert_array_equal(finals[0], finals[1])
    np.testing.assert_array_equal(finals[0], finals[2])


def test_place_into_closed_cabinet_keeps_the_thing_in_hand() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT))
    reasons = run(
        backend, ("navigate to", "vegetable"), ("pick up", "vegetable"), ("navigate to", "cabinet"),
        ("place to", "cabinet"),
    )
    assert reasons == [None, None, None, "door_closed"]
    assert backend.world.robots["robot_0"].holding == "vegetable"


def test_place_into_open_cabinet() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT, doors={"cabinet": 1.4}))
    reasons = run(
        backend, ("navigate to", "vegetable"), ("pick up", "vegetable"), ("navigate to", "cabinet"),
        ("place to", "cabinet"), ("close door", "cabinet"),
    )
    assert reasons == [None] * 5
    assert backend.world.objects["vegetable"].place == Place("slot", "cabinet.0")
    assert backend.world.fixtures["cabinet"].door == "closed"


def test_opening_a_door_with_a_full_hand_drops() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT))
    run(backend, ("navigate to", "vegetable"), ("pick up", "vegetable"), ("navigate to", "microwave"))
    assert run(backend, ("open door", "microwave")) == ["dropped"]
    world = backend.world
    assert world.objects["vegetable"].place.relation == "floor"
    assert world.robots["robot_0"].holding is None
    assert world.fixtures["microwave"].door == "closed"


def test_refusals_move_nothing() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT))
    before = backend.data.qpos.copy()
    assert run(backend, ("pick up", "vegetable"), ("place to", "sink")) == ["not_at_station", "hands_empty"]
    np.testing.assert_allclose(backend.data.qpos, before, atol=1e-3)


def test_microwave_runs_by_its_button_and_stops_when_opened() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT))
    assert run(backend, ("navigate to", "microwave"), ("turn on", "microwave")) == [None, None]
    assert backend.world.fixtures["microwave"].on == {"microwave"}
    assert run(backend, ("open door", "microwave")) == [None]
    assert backend.world.fixtures["microwave"].on == frozenset()
    assert run(backend, ("turn on", "microwave")) == ["blocked"]


def test_two_robots_swap_stations_without_coming_near() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT, robots=("robot_0", "robot_1")))
    there = {"robot_0": Subtask("navigate to", "stove"), "robot_1": Subtask("navigate to", "sink")}
    back = {"robot_0": Subtask("navigate to", "sink"), "robot_1": Subtask("navigate to", "stove")}
    for commands in (there, back, there):
        result = backend.run_round(commands)
        assert all(outcome.success for outcome in result.outcomes.values()), result.outcomes
        assert result.counters.near_misses == 0
    assert result.world.robots["robot_0"].station == "stove"


def test_names_of_robots_do_not_matter() -> None:
    finals = []
    for robots in (("robot_0", "robot_1"), ("robot_1", "robot_0")):
        backend = PhysicsBackend()
        backend.reset(make_start(CARROT, robots=robots))
        first, second = robots
        outcomes = []
        for one, other in (
            (Subtask("navigate to", "vegetable"), Subtask("navigate to", "sink")),
            (Subtask("pick up", "vegetable"), Subtask("turn on", "faucet")),
            (Subtask("navigate aside"), Subtask("navigate to", "microwave")),
        ):
            result = backend.run_round({first: one, second: other}).outcomes
            outcomes.append((result[first], result[second]))
        finals.append(outcomes)
    assert finals[0] == finals[1]


def test_a_backend_without_a_start_says_so() -> None:
    with pytest.raises(LifecycleError, match="reset"):
        PhysicsBackend().run_round({"robot_0": WAIT})


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda backend: pickle.loads(pickle.dumps(backend))])
def test_a_copy_goes_on_as_the_original(copied: Callable[[PhysicsBackend], PhysicsBackend]) -> None:
    backend = PhysicsBackend()
    backend.reset(make_start(CARROT))
    run(backend, ("navigate to", "vegetable"))
    other = copied(backend)
    assert run(other, ("pick up", "vegetable")) == [None]
    assert (backend.positions() != other.positions()).any()  # the copy moved, the original did not
    assert run(backend, ("pick up", "vegetable")) == [None]
    assert (backend.positions() == other.positions()).all()


def test_turning_the_stove_off_turns_every_burner_off() -> None:
    backend = PhysicsBackend()
    start = make_start(CARROT)
    lit = start.world.with_fixture("stove", on=frozenset({"stove.0", "stove.2"}))
    world = backend.reset(replace(start, world=lit))
    assert world.fixtures["stove"].on == {"stove.0", "stove.2"}
    assert run(backend, ("navigate to", "stove"), ("turn off", "stove")) == [None, None]
    assert backend.world.fixtures["stove"].on == set()


def test_robots_change_places_while_one_holds_something() -> None:
    backend = PhysicsBackend()
    backend.reset(make_start({"bottle": ("bottle", Place("slot", "counter.1"))}, robots=("robot_0", "robot_1")))
    run(backend, ("navigate to", "bottle"), ("pick up", "bottle"), ("navigate to", "stove"))
    change = {"robot_0": Subtask("navigate aside"), "robot_1": Subtask("navigate to", "stove")}
    outcomes = backend.run_round(change).outcomes
    assert {name: outcome.reason for name, outcome in outcomes.items()} == {"robot_0": None, "robot_1": None}
