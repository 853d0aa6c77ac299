"""Two robots in every layout: wherever one stands, the other gets from place to place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import mujoco
import numpy as np
import pytest
from physics_kit import stand

import remac_env
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure
from remac_env.backends.physics.drives import DriveGoal
from remac_env.backends.physics.encounters import Encounter
from remac_env.backends.physics.multi_robot import MultiRobotPlanner
from remac_env.backends.physics.simulation import Simulation
from remac_env.backends.physics.team import Team
from remac_env.backends.physics.timetable import Timetable
from remac_env.kitchen import layout as layouts
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.robots.panda import measures as panda

ROBOTS = ("robot_0", "robot_1")

SAMPLE = 40
"""Drives tried in each layout, beside the narrow ones."""

OFF = np.array([0.02, 0.02, 0.03])
"""m, m, rad: how far from their places drives may end."""

Drive = tuple[str, str, str]
"""Where one robot stands, and from where to where the other goes."""

NARROW: dict[str, tuple[Drive, ...]] = {
    "l_shaped_small": (
        ("cabinet", "counter_left", "microwave"),
        ("cabinet", "microwave", "counter_left"),
        ("cabinet", "counter_left", "fridge"),
        ("cabinet", "counter_front", "counter_left"),
    ),
    "l_shaped_large": (
        ("cabinet", "counter_right", "stove"),
        ("cabinet", "stove", "counter_left"),
        ("cabinet", "aside_left", "stove"),
        ("cabinet", "stove", "aside_right"),
    ),
}
"""Ways past somebody beside a corner."""


def places(layout: Layout) -> dict[str, Station]:
    return {**layout.stations, **{place.name: place for place in layout.asides}}


def drives(layout: Layout, chance: np.random.Generator) -> Iterator[Drive]:
    """The narrow drives of a layout, and a sample of all others that claims allow."""
    yield from NARROW.get(layout.name, ())
    conflicts = layout.conflicts()
    possible = [
        drive
        for drive in permutations(places(layout), 3)
        if not any(frozenset((drive[0], other)) in conflicts for other in drive[1:])
    ]
    for k in chance.choice(len(possible), SAMPLE, replace=False):
        yield possible[k]


@pytest.mark.few(1)
@pytest.mark.parametrize("name", layouts.names())
def test_a_robot_passes_another_wherever_that_stands(name: str) -> None:
    env = remac_env.parallel_env("OpenCabinetPnP", layout=name, backend="symbolic")
    env.reset(seed=1)
    layout, chance = layouts.load(name), np.random.default_rng(1)
    simulation = Simulation(build_model(layout, robots=ROBOTS, objects={}, visual=False), ROBOTS)
    team = Team(simulation, layout, {}, env.start, {})

    def near(place: str) -> Station:
        dx, dy, turn = chance.uniform(-1.0, 1.0, 3) * OFF
        exact = places(layout)[place]
        return replace(exact, x=exact.x + dx, y=exact.y + dy, yaw=exact.yaw + turn)

    def way(drive: Drive) -> bool:
        for here, place in zip(team.robots.values(), drive, strict=False):
            station = near(place)
            stand(simulation, here, panda.tucked(station.x, station.y, station.yaw))
            here.enter(station)
        mujoco.mj_forward(simulation.model, simulation.data)
        drive_goal = DriveGoal(team.robots["robot_1"], near(drive[2]))
        try:
            next(MultiRobotPlanner(team.separation, {"robot_1": drive_goal}, ()).steps("robot_1"))
        except SkillFailure:
            return False
        return True

    assert [drive for drive in drives(layout, chance) if not way(drive)] == []


def test_boxes_tell_only_of_what_is_free_and_spare_most_checks() -> None:
    """Straight drives from anywhere to anywhere, through furniture too: the same answers as without boxes."""
    env = remac_env.parallel_env("OpenCabinetPnP", robots=2, layout="u_shaped_large", backend="symbolic")
    env.reset(seed=3)
    layout, chance = layouts.load("u_shaped_large"), np.random.default_rng(5)
    simulation = Simulation(build_model(layout, robots=ROBOTS, objects={}, visual=False), ROBOTS)
    team = Team(simulation, layout, {}, env.start, {})
    here = team.robots["robot_1"]
    here.leave()
    timetable, checker = Timetable(team.separation, {}, ()), here.clear.checker
    driver = timetable._driver(DriveGoal(here, layout.asides[0]))
    blind = replace(driver, obstacles=(np.zeros((0, 3)), np.zeros((0, 3))))
    found, spent, missed = {True: 0, False: 0}, [0, 0], 0
    for _ in range(60):
        corners = [here.robot.q.copy(), here.robot.q.copy()]
        for q in corners:
            q[:3] = chance.uniform((layout.room.x[0], -2.5, -3.0), (layout.room.x[1], 0.0, 3.0))
        counts = [checker.checks]
        quick = timetable._free(driver, corners)
        counts.append(checker.checks)
        with checker.without_robots():
            slow = bool(here.clear.planner.edge(*corners, 0.1))
        counts.append(checker.checks)
        assert quick == slow, corners
        found[slow] += 1
        spent = [spent[k] + slow * (counts[k + 1] - counts[k]) for k in (0, 1)]
        missed += timetable._free(blind, corners) != slow
    assert min(found.values()) > 5
    assert spent[0] < 0.5 * spent[1]
    assert missed > 0, "boxes that leave something out are found"


def test_many_pairs_of_ways_are_not_tried_before_one_robot_makes_room(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no pair of ways passes, the robots go one after the other after few tries, and not after thousands."""
    name, tried, asked = "one_wall_large", [0], []
    env = remac_env.parallel_env("OpenCabinetPnP", layout=name, robots=2, backend="symbolic")
    env.reset(seed=1)
    layout = layouts.load(name)
    simulation = Simulation(build_model(layout, robots=ROBOTS, objects={}, visual=False), ROBOTS)
    team = Team(simulation, layout, {}, env.start, {})
    swap = {"robot_0": ("sink", "stove"), "robot_1": ("stove", "sink")}
    for robot, (place, _) in swap.items():
        station, here = layout.stations[place], team.robots[robot]
        stand(simulation, here, panda.tucked(station.x, station.y, station.yaw))
        here.enter(station)
    mujoco.mj_forward(simulation.model, simulation.data)
    team.separation.refresh()

    def never(self: Encounter, delays: tuple[int, int]) -> bool:
        tried[0] += 1
        return False

    def by_turns(self: Timetable, drivers: object) -> None:
        asked.append(tried[0])

    monkeypatch.setattr(Encounter, "passes", never)
    monkeypatch.setattr(Timetable, "_by_turns", by_turns)
    drive_goals = {robot: DriveGoal(team.robots[robot], layout.stations[goal]) for robot, (_, goal) in swap.items()}
    with pytest.raises(SkillFailure):
        next(MultiRobotPlanner(team.separation, drive_goals, ()).steps("robot_0"))
    assert len(asked) == 1 and 0 < asked[0] <= 200
    assert tried[0] > 500, "after that the others are tried all the same"
