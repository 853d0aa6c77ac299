"""The robots of an episode: their workspace, what they know of one another when they begin, and where drives end."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import replace

import numpy as np

from remac_env.backends.physics.attempts import NEIGHBOUR, Attempts, Orders, keep_out_plane
from remac_env.backends.physics.controllers.base import Command, MakeController
from remac_env.backends.physics.controllers.scripted.collision import CollisionChecker
from remac_env.backends.physics.controllers.scripted.controller import ended
from remac_env.backends.physics.controllers.scripted.motion import Mover
from remac_env.backends.physics.controllers.scripted.paths import Planner
from remac_env.backends.physics.controllers.scripted.robot import Robot, View
from remac_env.backends.physics.controllers.scripted.skill import hold
from remac_env.backends.physics.controllers.scripted.workspace import Clear, Hand, Kitchen, Workspace
from remac_env.backends.physics.drives import DriveGoal
from remac_env.backends.physics.multi_robot import MultiRobotPlanner
from remac_env.backends.physics.navigate import parking
from remac_env.backends.physics.pilot import Attempt, Pilot
from remac_env.backends.physics.sensing import Senses
from remac_env.backends.physics.separation import Separation
from remac_env.backends.physics.simulation import Simulation
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.objects.catalogue import Category
from remac_env.rules.facts import ASIDE
from remac_env.rules.outcomes import Outcome
from remac_env.seeding import generator
from remac_env.start import Start

_ARRIVAL = np.array([0.02, 0.02, 0.03])  # m, m, rad: how far off a drive ends at most; known to the robot afterwards


class Team:
    """All robots. ``robots`` holds each one's workspace by name."""

    def __init__(
        self, simulation: Simulation, layout: Layout, objects: Mapping[str, Category], start: Start,
        controllers: Mapping[str, MakeController],
    ) -> None:
        self._layout, self._start = layout, start
        self.separation = Separation(simulation)
        kinematics = simulation.body.kinematics()
        self.robots: dict[str, Workspace] = {}
        self.pilots: dict[str, Pilot] = {}
        for name, handle in simulation.robots.items():
            robot = Robot(handle, kinematics)
            view = View(Senses(simulation, handle, layout, objects), robot)
            checker = CollisionChecker(view, robot)
            clear = Clear(checker, Planner(checker, np.random.default_rng(0)))
            x, y, yaw = (float(value) for value in robot.q[:3])
            self.robots[name] = Workspace(
                view, Kitchen(layout, objects), clear, robot, Mover(robot), Hand(), Station(ASIDE, x, y, yaw)
            )
            own = {skill: make() for skill, make in controllers.items()}
            self.pilots[name] = Pilot(simulation, self.robots[name], start.scene, own, start.seed)
        self._attempts = Attempts(simulation, self.separation, self.pilots, layout)

    def hold(self, objects: Mapping[str, str | None]) -> None:
        """Tell robots what their hands hold now."""
        for name, body in objects.items():
            hold(self.robots[name], body)

    def attempts(self, now: Orders) -> dict[str, Attempt]:
        """A generator for every robot with an accepted subtask; each returns its outcome. None of them may be busy."""
        self._hold()
        self._set_keep_out(now)
        self._disturb(now)
        goals = {name: self._arrival(now.number, place) for name, place in self._goals(now).items()}
        return self._attempts.begin(now, goals)

    def driven(self, robot: str, goal: Station) -> Generator[Command, None, Outcome]:
        """What the scripted controller wants of a robot that drives to ``goal`` while all others stand."""
        self._hold()
        here = self.robots[robot]
        return ended(here, MultiRobotPlanner(self.separation, {robot: DriveGoal(here, goal)}, ()).steps(robot))

    def finished(self, robot: str) -> None:
        """Note that a robot's attempt has ended."""
        self._attempts.finished(robot)

    # -- before they begin -------------------------------------------------------------------------------------------

    def _hold(self) -> None:
        """What hands hold is part of the robots from now on."""
        self.separation.holding({n: here.hand.body for n, here in self.robots.items() if here.hand.body is not None})

    def _set_keep_out(self, now: Orders) -> None:
        """Keep-out planes between robots that work at neighbouring stations, or next to where another drives."""
        busy = self._attempts.under_way
        for name, here in self.robots.items():
            if name in busy:
                continue
            here.clear.checker.keep_out = ()
            if name in now.driving:
                continue
            for other in sorted((now.active | busy) - {name}):
                there = self.robots[other].place
                for end in (there, self._layout.stations.get(now.stations[other], there)):
                    if end.wall and 0.0 < here.place.distance(end) <= NEIGHBOUR:
                        here.clear.checker.keep_out += (keep_out_plane(here.place, end),)

    def _disturb(self, now: Orders) -> None:
        """Draw the errors in the poses that controllers see."""
        noise = self._start.perception_noise
        if not noise:
            return
        busy = self._attempts.under_way
        for here in (here for name, here in self.robots.items() if name not in busy):
            place = [round(float(value), 3) for value in here.robot.standing[:2]]
            chance = generator(self._start.seed, "perception", now.number, *place)
            here.sensed.senses.look(chance, noise, here.hand.body)
            here.clear.checker.look()

    def _goals(self, now: Orders) -> dict[str, Station]:
        """Where driving robots go; those that step aside and find no free parking place are left out."""
        going = sorted(now.driving)
        to_stations = {r: self._layout.stations[now.stations[r]] for r in going if now.stations[r] != ASIDE}
        away = {r: self.robots[r].robot.standing for r in going if now.stations[r] == ASIDE}
        taken = [here.robot.standing for name, here in self.robots.items() if name not in now.driving]
        taken += [np.array([aim.x, aim.y, aim.yaw]) for aim in self._attempts.aims.values() if aim is not None]
        return to_stations | parking(self._layout, away, taken)

    def _arrival(self, number: int, place: Station) -> Station:
        """Where a drive to a place really ends: a little off, so that skills start from stances never seen before."""
        chance = generator(self._start.seed, "arrival", number, place.name)
        dx, dy, turn = (float(value) for value in chance.uniform(-1.0, 1.0, 3) * _ARRIVAL)
        return replace(place, x=place.x + dx, y=place.y + dy, yaw=place.yaw + turn)
