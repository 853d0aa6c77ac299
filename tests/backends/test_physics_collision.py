"""The checked world: what counts as a collision, and that the simulation is left alone."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from remac_env.backends.physics.controllers.scripted.collision import CollisionChecker, KeepOutPlane
from remac_env.backends.physics.controllers.scripted.paths import Planner
from remac_env.backends.physics.controllers.scripted.robot import Robot, View
from remac_env.backends.physics.controllers.scripted.verdicts import Hit
from remac_env.backends.physics.pose import FrameError, Pose
from remac_env.backends.physics.sensing import Senses
from remac_env.backends.physics.simulation import Simulation
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.kitchen.objects import catalogue
from remac_env.robots import bodies
from remac_env.robots.panda import measures as panda

DOWN = np.diag([1.0, -1.0, -1.0])


@pytest.fixture(scope="module")
def kitchen() -> tuple[Simulation, CollisionChecker, Planner]:
    model = build_model(layouts.load("one_wall_large"), robots=("robot_0", "robot_1"), objects={"vegetable": "potato"})
    simulation = Simulation(model, ("robot_0", "robot_1"))
    simulation.robots["robot_0"].put(panda.tucked(0.1, -0.85, 0.5 * np.pi))
    simulation.robots["robot_1"].put(panda.tucked(1.5, -2.3, 0.5 * np.pi))
    simulation.place("vegetable", np.array([0.11, 0.24, 0.928]), np.array([1.0, 0.0, 0.0, 0.0]))
    mujoco.mj_forward(model, simulation.data)
    layout, handle = layouts.load("one_wall_large"), simulation.robots["robot_0"]
    robot = Robot(handle, bodies.get().kinematics())
    objects = {"vegetable": catalogue.get("potato")}
    checker = CollisionChecker(View(Senses(simulation, handle, layout, objects), robot), robot)
    return simulation, checker, Planner(checker, np.random.default_rng(0))


def test_home_is_free_and_furniture_is_not(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    simulation, checker, _ = kitchen
    checker.begin()
    home = panda.tucked(0.1, -0.85, 0.5 * np.pi)
    assert checker.free(home)
    met = checker.free(panda.tucked(0.1, 0.1, 0.5 * np.pi))
    assert isinstance(met, Hit) and not met and met.a != met.b and str(met) == f"{met.a} meets {met.b}"
    before = simulation.data.qpos.copy()
    checker.free(panda.tucked(0.3, -1.0, 0.0))
    np.testing.assert_array_equal(simulation.data.qpos, before)


def test_the_other_robot_is_an_obstacle(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    _, checker, _ = kitchen
    checker.begin()
    beside = panda.tucked(1.2, -2.3, 0.5 * np.pi)
    assert not checker.free(beside)
    with checker.without_robots():
        assert checker.free(beside)
    assert not checker.free(beside)


def test_a_keep_out_plane_keeps_the_robot_in_its_room(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    _, checker, _ = kitchen
    checker.begin()
    home = panda.tucked(0.1, -0.85, 0.5 * np.pi)
    right = KeepOutPlane(1.0, 0.0, 0.5)
    checker.keep_out = (KeepOutPlane(-1.0, 0.0, 0.3), right)
    assert checker.free(home)
    checker.keep_out = (KeepOutPlane(-1.0, 0.0, 0.0), right)
    assert not checker.free(home)
    checker.keep_out = ()


def test_gripper_may_touch_its_target_only(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    simulation, checker, planner = kitchen
    checker.begin()
    base = np.array([0.11, -0.31, 0.5 * np.pi])
    goals = planner.reach(Pose(np.array([0.11, 0.24, 0.93]), DOWN, WORLD), base, panda.tucked(*base))
    assert goals
    checker.fingers(0.02)
    assert not any(checker.free(goal) for goal in goals)
    checker.begin(target=simulation.geoms("vegetable"))
    checker.fingers(0.02)
    assert any(checker.free(goal) for goal in goals)


def test_a_pose_of_another_frame_is_refused(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    simulation, checker, planner = kitchen
    base, wall = np.array([0.11, -0.31, 0.5 * np.pi]), Frame(0.5, 0.0, 1, "wall left")
    pose = Pose(np.array([0.11, 0.24, 0.93]), DOWN, WORLD)
    told = pose.seen_from(wall)
    uses: tuple[Callable[[Pose], object], ...] = (
        lambda pose: planner.reach(pose, base, panda.tucked(*base)),
        lambda pose: planner.line(panda.tucked(*base), pose),
        lambda pose: checker.robot.grip_pose().of(pose),
    )
    for use in uses:
        with pytest.raises(FrameError, match="wall left.*is used in .*room"):
            use(told)
        use(told.in_room())
        use(pose)


def test_released_things_go_back_to_where_they_are(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    simulation, checker, _ = kitchen
    checker.begin()
    before = checker.data.qpos.copy()
    checker.hold("vegetable", checker.robot.grip_pose(), simulation.pose("vegetable"))
    checker.free(panda.tucked(0.1, -1.0, 0.5 * np.pi))
    checker.release()
    address = int(simulation.model.joint("vegetable").qposadr[0])
    np.testing.assert_array_equal(checker.data.qpos[address : address + 7], before[address : address + 7])


def test_a_found_path_is_free_all_along(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    _, checker, planner = kitchen
    checker.begin()
    start = panda.tucked(0.1, -0.85, 0.5 * np.pi)
    goal = np.concatenate([start[:3], [0.3], panda.HOME_ARM + [1.5, 0, 0, 0, 0, 0, 0]])
    path = planner.path(start, goal)
    assert path is not None and np.array_equal(path[-1], goal)
    corners = [start, *path]
    for k in range(len(path)):
        for u in np.linspace(0, 1, 25):
            assert checker.free(corners[k] + u * (corners[k + 1] - corners[k]))


def test_planning_is_the_same_every_time(kitchen: tuple[Simulation, CollisionChecker, Planner]) -> None:
    _, checker, _ = kitchen
    checker.begin()
    start = panda.tucked(0.1, -0.55, 0.5 * np.pi)
    goal = np.concatenate([start[:3], [0.2], panda.HOME_ARM])
    paths = [Planner(checker, np.random.default_rng(5)).path(start, goal, via=False) for _ in range(2)]
    assert paths[0] is not None and paths[1] is not None
    for one, other in zip(paths[0], paths[1], strict=True):
        np.testing.assert_array_equal(one, other)
