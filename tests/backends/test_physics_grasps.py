"""What robots make of where they stand: the nearest turn of their bodies, and which part of a ring hands take."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from physics_kit import stand

from remac_env.backends.physics.controllers.scripted.grasps import candidates
from remac_env.backends.physics.pose import Pose
from remac_env.backends.physics.simulation import Simulation
from remac_env.backends.physics.stage import pose_start
from remac_env.backends.physics.team import Team
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.frame import WORLD
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.objects.colliders import WALL_PIECES
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.robots import bodies
from remac_env.robots.rotation import about_z
from remac_env.start import Offset, Start
from remac_env.state import FrozenMap, RobotState, WorldState

ROBOT = "robot_0"
NO_THINGS: Mapping[str, str] = {}


@pytest.fixture(scope="module")
def team() -> tuple[Simulation, Team]:
    layout = layouts.load("u_shaped_large")
    scene = build_scene(layout, {}, (ROBOT,))
    world = WorldState(FrozenMap({ROBOT: RobotState()}), FrozenMap({}), resting_fixtures(scene))
    start = Start(
        scene=scene, world=world, layout=layout.name, style="coastal", categories=NO_THINGS, offsets={},
        robots={ROBOT: (0, Offset())}, doors={}, seed=1,
    )
    simulation = Simulation(build_model(layout, robots=(ROBOT,), objects={}), (ROBOT,))
    pose_start(simulation, layout, {}, start)
    return simulation, Team(simulation, layout, {}, start, {})


@pytest.mark.parametrize("rounds", [-2, -1, 0, 1, 2])
def test_a_robot_that_has_gone_round_does_not_turn_back_to_come_home(
    team: tuple[Simulation, Team], rounds: int
) -> None:
    simulation, robots = team
    here, layout = robots.robots[ROBOT], layouts.load("u_shaped_large")
    assert len({station.wall for station in layout.stations.values()}) == 3
    for station in layout.stations.values():
        here.leave()
        q = here.robot.q.copy()
        q[:3] = station.x, station.y, station.yaw + rounds * math.tau
        stand(simulation, here, q)
        here.enter(station)
        assert here.station.yaw == pytest.approx(float(here.robot.q[2]), abs=1e-9), station.name


@pytest.mark.parametrize("category", ["plate", "bowl"])
@pytest.mark.parametrize("yaw", [0.0, 0.2, -1.4, 3.0])
def test_a_rim_is_taken_in_the_middle_of_a_piece_the_nearest_first(category: str, yaw: float) -> None:
    obj, position = catalogue.get(category), np.array([0.3, 0.2, 0.93])
    found = candidates(obj, Pose(position, about_z(yaw), WORLD), bodies.get())
    around = []
    for grasp in found:
        local = about_z(yaw).T @ (grasp.position - position)
        pieces = math.atan2(local[1], local[0]) / (math.tau / WALL_PIECES)
        assert pieces == pytest.approx(round(pieces), abs=1e-6)
        around.append(round(pieces) % WALL_PIECES)
    assert set(around) == set(range(WALL_PIECES))
    first = found[0].position - position
    assert abs(math.remainder(math.atan2(first[1], first[0]) + 0.5 * math.pi, math.tau)) <= math.pi / WALL_PIECES + 1e-6
