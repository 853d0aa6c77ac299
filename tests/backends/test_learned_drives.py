"""Drives that are learned: the way that is found on the floor plan, how it looks, and when a drive is over."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from itertools import islice
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.learned import drive as drive_module
from remac_env.backends.physics.controllers.learned.cases import CARRYING
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.drive import CORNERS, Drive, seen_corners, way_to
from remac_env.backends.physics.controllers.learned.library import SHIPPED, file_name
from remac_env.backends.physics.controllers.learned.seen import entries, overlooked
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.backends.physics.controllers.learned.weights import read_weights
from remac_env.backends.physics.routes import placed, sampled
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.floor import TALL
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.layout_checks import world_blocks
from remac_env.lowlevel.starts import ROBOT, get_ready
from remac_env.robots import bodies
from remac_env.rules.skills import SKILLS

BODY = bodies.get()
PLAN = "g_shaped_small"


def standing(place: Station) -> np.ndarray:
    return np.asarray(BODY.tuck(place.x, place.y, place.yaw), float)


def overlaps(layout: Layout, way: list[np.ndarray]) -> bool:
    """Whether a base on this way is ever over what stands on the floor; its edge is looked at every 3 cm."""
    (back, right), (front, left) = BODY.footprint
    x, y = np.arange(back, front, 0.03), np.arange(right, left, 0.03)
    sides = [(x, right + 0.0 * x), (x, left + 0.0 * x), (back + 0.0 * y, y), (front + 0.0 * y, y)]
    edge = np.concatenate([np.column_stack(side) for side in sides])
    points = placed(edge, np.array(sampled(way, BODY))[::4, :3]).reshape(-1, 2)
    for fixture in layout.fixtures.values():
        for block in world_blocks(layout, fixture):
            low, high = np.array(block.low[:2]) + 0.005, np.array(block.high[:2]) - 0.005
            if block.low[2] < TALL and ((low < points) & (points < high)).all(axis=1).any():
                return True
    return False


def test_a_way_leads_around_what_stands_on_the_floor() -> None:
    layout, straight = layouts.load(PLAN), 0
    place = layout.asides[0]
    for goal in layout.stations.values():
        start, end = standing(place), standing(goal)
        way = way_to(layout, place, start, goal, BODY)
        assert np.array_equal(way[0][:3], start[:3]) and np.allclose(way[-1][:2], end[:2])
        assert math.cos(way[-1][2] - goal.yaw) == pytest.approx(1.0)
        assert not overlaps(layout, way), goal.name
        straight += overlaps(layout, [start, end])
    assert straight, "going straight to some of them would not do: the check can fail"


def drive(place: Station, goal: Station, layout: Layout) -> tuple[Drive, Any]:
    body = SimpleNamespace(q=standing(place))
    sensing: Any = SimpleNamespace(layout=layout, station=place, goal=goal, body=body)
    return Drive(sensing, Stand.at(layout, goal), BODY), body


def test_a_drive_goes_from_corner_to_corner_and_is_over_at_its_end() -> None:
    layout = layouts.load(PLAN)
    place, goal = layout.stations["sink"], layout.stations["fridge"]
    aim, body = drive(place, goal, layout)
    way, shown, over = way_to(layout, place, standing(place), goal, BODY), [], []
    assert len(way) > 3 and aim.missed() and not aim.over()
    for body.q in sampled(way, BODY):
        aim.update()
        shown.append(aim.ahead().reshape(CORNERS, 4))
        over.append(aim.over())
    far = np.sinh(np.array(shown)[:, :, 2]) * 0.02
    assert far[0, 0] < 0.01 and far[0, 1] == pytest.approx(np.linalg.norm((way[1] - way[0])[:2]), abs=0.01)
    assert far[-1, 1:].max() < 0.01 and over[-1] and not aim.missed() and aim.done() > 0.99
    assert not any(over[: -len(over) // 10]), "on the way it is not over"
    body.q = body.q + np.array([0.03, *[0.0] * 10])
    assert not aim.over() and not aim.missed(), "near, but not there"
    body.q = body.q + np.array([0.0, 0.2, *[0.0] * 9])
    assert aim.missed()


def test_corners_are_seen_the_finer_the_nearer_they_are() -> None:
    right, to_wall, far, turn = seen_corners(np.array([[0.0, -2.0]]), np.array([0.5]))
    assert (right, to_wall) == (0.0, -1.0) and far == pytest.approx(math.asinh(100.0))
    assert turn == pytest.approx(math.asinh(25.0))
    near, nearer = (seen_corners(np.array([[x, 0.0]]), np.zeros(1))[2] for x in (0.02, 0.01))
    there, beyond = (seen_corners(np.array([[x, 0.0]]), np.zeros(1))[2] for x in (4.02, 4.01))
    assert near - nearer > 50 * (there - beyond)
    assert seen_corners(np.zeros((1, 2)), np.zeros(1)).tolist() == [0.0] * 4


def test_the_same_way_looks_the_same_at_every_wall() -> None:
    layout, seen = layouts.load(PLAN), []
    for goal in layout.stations.values():
        stand = Stand.at(layout, goal)
        x, y, _ = stand.axes @ [0.4, -0.2, 0.0]
        place = Station("here", goal.x + x, goal.y + y, goal.yaw, goal.wall)
        aim, _ = drive(place, goal, layout)
        aim._corners = np.array([standing(place)[:3], standing(goal)[:3]])
        seen.append(aim.ahead())
    assert len({goal.wall for goal in layout.stations.values()}) > 1
    assert np.allclose(seen, seen[0], atol=1e-9)


def test_drives_are_learned_from_the_way_alone_and_other_skills_from_all_that_is_seen() -> None:
    names = [entry.name for entry in entries(SKILLS["navigate to"])]
    blind = {names[number] for number in overlooked(SKILLS["navigate to"])}
    assert {"base_x", "base_yaw_cos", "hand_x", "target_x", "range_0", "joint1", "opening"} <= blind
    assert not {"corner0_far", "corner2_turn"} & blind
    assert not any(overlooked(skill) for skill in SKILLS.values() if skill.target != "none" and not skill.moves)


@pytest.fixture(scope="module")
def laden() -> tuple[Any, PhysicsBackend]:
    """A drive that begins with something in the hand."""
    ready, backend = get_ready(
        {}, SKILLS["navigate to"], "sink", 3, style="modern_1", layout="one_wall_large", cases=(CARRYING,)
    )
    assert ready.case == CARRYING and ready.before[-1].row.takes
    return ready, backend


def test_a_learned_drive_moves_the_base_and_nothing_else(laden: tuple[Any, PhysicsBackend]) -> None:
    ready, backend = laden
    sensing = backend.by_hand(ROBOT, ready.subtask).sensing
    wild = read_weights(SHIPPED / file_name("navigate to"))
    object.__setattr__(wild, "network", SimpleNamespace(commands=lambda seen: np.full((8, 12), 0.04, np.float32)))
    arm, fingers = sensing.body.commanded[3:], sensing.body.commanded_opening
    commands = list(islice(Learned(wild).run(ready.subtask, sensing), 24))
    assert all(np.array_equal(command.q[3:], arm) and command.opening == fingers for command in commands)
    assert np.linalg.norm(commands[-1].q[:2] - sensing.body.q[:2]) > 0.03


def test_drives_are_learned_with_and_without_something_in_the_hand(laden: tuple[Any, PhysicsBackend]) -> None:
    ready, backend = laden
    learned = Learned(read_weights(SHIPPED / file_name("navigate to")))
    sensing = backend.by_hand(ROBOT, ready.subtask).sensing
    assert learned.covers(ready.subtask, sensing)
    assert learned.covers(ready.subtask, replace(sensing, told=sensing.told.with_robot(ROBOT, holding=None)))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(4))
def test_the_packages_own_drives_bring_what_they_carry(seed: int) -> None:
    weights, skill = read_weights(SHIPPED / file_name("navigate to")), SKILLS["navigate to"]
    ready, backend = get_ready(
        {}, skill, None, seed, style="coastal", layout=PLAN, cases=(CARRYING,),
        make=partial(PhysicsBackend, controllers={skill.name: partial(Learned, weights)}),
    )  # fmt: skip
    held = backend.world.robots[ROBOT].holding
    assert backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT].success
    assert held is not None and backend.world.robots[ROBOT].holding == held


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_the_packages_own_drives_arrive_where_they_were_never_shown(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    weights, skill = read_weights(SHIPPED / file_name("navigate to")), SKILLS["navigate to"]

    def driven() -> Any:
        ready, backend = get_ready(
            {}, skill, "fridge", seed, style="coastal", layout=PLAN,
            make=partial(PhysicsBackend, controllers={skill.name: partial(Learned, weights)}),
        )  # fmt: skip
        return backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT]

    assert driven().success
    nowhere = lambda layout, place, q, goal, body: [q, q + 1.0]  # noqa: E731 - a way that leads elsewhere
    monkeypatch.setattr(drive_module, "way_to", nowhere)
    assert not driven().success, "it follows its way, and knows the station by no other means"
