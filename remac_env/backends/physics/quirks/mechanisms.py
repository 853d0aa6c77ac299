"""What moves parts of a kitchen beside robots: springs at joints, and what they look at. Forces, never positions."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from remac_env.backends.physics.happened import Happened
from remac_env.backends.physics.simulation import Simulation
from remac_env.backends.physics.snapshot import station_of
from remac_env.kitchen.fixtures.actuator import Actuator
from remac_env.kitchen.fixtures.base import FixtureReading
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.rules.facts import ASIDE, Rules

NEAR = 0.75
"""m from the station to which it came within which a robot is there, also while it moves about at work; it may come
nearer to the next one then, 0.84 m away."""

LET_GO = 10
"""Control periods without a hand after which a catch or glue gives way."""

TURN = 400
"""Control periods (20 s) for which what somebody has to stand at stays as it is once it was left: as long as robots
need to take turns within a round, in which what holds when it begins holds to its end."""

_OPEN = 30  # control periods for which a hand stays open that was made to open
_SHARE = 0.3  # of the change of speed still wanted that a drive brings about in one step
_STRENGTH = 4.0  # dry frictions of its joint that a drive gives at most: a hand is stronger
_SLOWDOWN = 0.1  # s before its end over which a drive slows down
_STOP = 500.0  # N m/rad or N/m, of a catch for each kg m2 or kg of 0.17 that a cabinet's door has
_STRONG = 60.0  # N m at a door, which is 150 N at its handle: more than a hand holds
_BACK = 0.03  # rad from off at which a switch is off
_RETURN = 3.0  # rad/s with which a switch comes back


class Surroundings:
    """A kitchen as mechanisms see it."""

    def __init__(
        self, simulation: Simulation, scene: Rules, layout: Layout, objects: Mapping[str, Category], happened: Happened
    ) -> None:
        self.simulation, self.scene, self.layout = simulation, scene, layout
        self.objects, self.happened = objects, happened
        model = simulation.model
        names = [model.body(body).name for body in range(model.nbody)]
        self._came: dict[str, str] = {}
        self._opening: dict[str, int] = {}
        self._robots = np.array([any(name.startswith(f"{r}/") for r in simulation.robots) for name in names])

    def watch(self) -> None:
        """Note which robots have come to a station, and let hands close again, after every control period."""
        here = ((name, station_of(robot, self.layout)) for name, robot in self.simulation.robots.items())
        self._came |= {name: station for name, station in here if station != ASIDE}

        for name in self._opening:
            self._opening[name] = max(0, self._opening[name] - 1)
            self.simulation.robots[name].let_go = self._opening[name] > 0

    def open_hand(self, robot: str) -> None:
        """Let its motors open a hand, and keep it open for a while."""
        self._opening[robot] = _OPEN
        self.simulation.robots[robot].let_go = True

    def reading(self, fixture: str) -> FixtureReading:
        """What a fixture's joints say."""
        return self.layout.fixtures[fixture].read(self.simulation.model, self.simulation.data)

    def on(self, fixture: str) -> bool:
        """Whether any of its switches is on."""
        running = self.happened.running & frozenset(self.layout.fixtures[fixture].switches)
        return bool(self.reading(fixture).on or running)

    def shut(self, fixture: str) -> bool:
        """Whether its door is closed."""
        return self.reading(fixture).door == "closed"

    def attended(self, fixture: str) -> bool:
        """Whether a robot stands where it is used."""
        there = self.scene.stations_of(fixture)
        return any(self._station(name) in there for name in self.simulation.robots)

    def _station(self, name: str) -> str | None:
        """The station that a robot came to last, while it is still near it."""
        if (came := self._came.get(name)) is None:
            return None
        place = self.layout.stations[came]
        x, y, _ = self.simulation.robots[name].standing
        return came if math.hypot(x - place.x, y - place.y) <= NEAR else None

    def touched(self, body: str) -> bool:
        """Whether any part of a robot touches a body."""
        model, data = self.simulation.model, self.simulation.data
        pairs = model.geom_bodyid[data.contact.geom[: data.ncon]]
        wanted = pairs == model.body(body).id
        return bool((wanted & self._robots[pairs[:, ::-1]]).any()) if len(pairs) else False


class JointDrive:
    """A spring with a damper at a joint of one degree: brings it somewhere at a steady speed, or stops it.

    What it applies goes on until it is told to `rest`. To be told anew before every step of 5 ms.
    """

    def __init__(self, simulation: Simulation, joint: str) -> None:
        model, self._data = simulation.model, simulation.data
        self._dof, self._qpos = int(model.joint(joint).dofadr[0]), int(model.joint(joint).qposadr[0])
        self._mass = float(model.dof_M0[self._dof])
        self._friction = float(model.dof_frictionloss[self._dof])
        self._step = float(model.opt.timestep)

    @property
    def position(self) -> float:
        """Where the joint is, rad or m."""
        return float(self._data.qpos[self._qpos])

    def toward(self, target: float, *, speed: float) -> None:
        """Go there, at most at this speed (rad/s or m/s)."""
        wanted = (target - self.position) / _SLOWDOWN
        wanted = math.copysign(min(abs(wanted), speed), wanted)
        pull = _SHARE * self._mass / self._step * (wanted - float(self._data.qvel[self._dof]))
        most = _STRENGTH * self._friction
        self._apply(min(max(pull, -most), most) + float(self._data.qfrc_bias[self._dof]))

    def stop_at(self, limit: float) -> None:
        """Let it go no further than there, as a catch does."""
        beyond = self.position - limit
        if beyond <= 0.0:
            self.rest()
            return
        share = self._mass / 0.17
        slowing = _SHARE * self._mass / self._step * float(self._data.qvel[self._dof])
        self._apply(-min(max(_STOP * share * beyond + slowing, 0.0), _STRONG * share))

    def rest(self) -> None:
        """Apply nothing."""
        self._apply(0.0)

    def _apply(self, force: float) -> None:
        self._data.qfrc_applied[self._dof] = force


class Switch:
    """One switch of a fixture, with a spring that brings it back once it is sent back."""

    def __init__(self, around: Surroundings, actuator: Actuator) -> None:
        self._around, self._actuator = around, actuator
        self._drive = None if actuator.springs_back else JointDrive(around.simulation, actuator.joint)
        self.returning = False
        self._was_on = self.on

    @property
    def name(self) -> str:
        """What is switched by it."""
        return self._actuator.switch

    @property
    def on(self) -> bool:
        """Whether it is on."""
        if self._drive is None:
            return self._actuator.switch in self._around.happened.running
        return self._drive.position >= self._actuator.counts

    def came_on(self) -> bool:
        """Whether it came on since this was asked last; to be asked after every control period."""
        before, self._was_on = self._was_on, self.on
        if self.returning and self._drive is not None and self._drive.position <= _BACK:
            self.returning = False
            self._drive.rest()
        return self._was_on and not before

    def send_back(self) -> None:
        """Turn it off: a spring brings a knob or lever back, what a button started stops."""
        if self._drive is None:
            self._around.happened.running -= {self.name}
            self._was_on = False
        else:
            self.returning = True

    def push(self) -> None:
        """Before every step of 5 ms."""
        if self.returning and self._drive is not None:
            self._drive.toward(0.0, speed=_RETURN)
