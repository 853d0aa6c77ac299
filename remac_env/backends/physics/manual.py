"""One robot that is moved from outside, a control period at a time: for policies that are being trained or tried."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.controllers.base import Command, CommandError, set_points
from remac_env.backends.physics.controllers.learned.aim import Aim
from remac_env.backends.physics.controllers.learned.aims import aim_of
from remac_env.backends.physics.controllers.learned.seen import observe
from remac_env.backends.physics.timeline import Timeline
from remac_env.errors import OptionError, PhysicsError
from remac_env.robots.rotation import Array
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState

LASTING = 6
"""Control periods for which what the skill achieves has to be true on end: as long as rounds wait at rest."""

_NEARLY = 0.9  # of it is done at most before the skill has succeeded
_BRINGING, _STEEP = 0.3, 3.0  # the part that is bringing the hand there, and how steeply that falls, 1/m


class Manual:
    """A robot with a subtask to do. ``command`` runs one control period of 0.05 s.

    Attributes:
        body: the name of the robot's body.
        sensing, aim: what the robot senses, and what the subtask is about.
        world: what geometry showed after the last period.
    """

    def __init__(self, timeline: Timeline, robot: str, subtask: Subtask) -> None:
        self._timeline, self._robot, self.subtask = timeline, robot, subtask
        self._pilot, self.body = timeline.pilot(robot), timeline.start.body
        self.world: WorldState = timeline.world
        self._scene = timeline.start.scene
        place = None if (goes := subtask.row.goes) is None else goes(self._scene, self.world, robot, subtask.target)
        stations = self._pilot.here.kitchen.layout.stations
        self.sensing = self._pilot.briefed(0, subtask, self.world, stations.get(str(place)))
        self.aim: Aim = aim_of(subtask, self.sensing, self.body)
        self._conditions = subtask.achieves(robot, self.world.robots[robot].holding)
        self._true_for = 0

    @property
    def q(self) -> Array:
        """The set-points (n,) in force, in the frame of the room."""
        return self.sensing.body.commanded

    @property
    def grip(self) -> float:
        """The set-point of each finger, m."""
        return self.sensing.body.commanded_opening

    def scripted(self, *, midway: bool = False) -> Generator[Command, None, Outcome]:
        """What the scripted controller wants, for who plays it himself; drives know of no other that drives meanwhile.

        ``midway``: from where the robot is by now, where objects are picked up or put down.

        Raises:
            OptionError: for a drive that leads nowhere, as no parking place is free.
        """
        self._pilot.here.midway = midway
        if midway:
            self._pilot.here.robot.catch_up()
        if not self.subtask.moves:
            return self._pilot.wanted(self.subtask, self.sensing)
        if self.sensing.goal is None:
            raise OptionError(f"{self.subtask.text!r} leads to no station; valid: a drive to a place of its own")
        return self._timeline.driven(self._robot, self.sensing.goal)

    def command(self, q: Array, grip: float) -> None:
        """Bring the set-points to ``q`` (n,) and ``grip`` (m) in one period, within the maker's limits.

        Raises:
            PhysicsError: for a command that is not finite, or if MuJoCo warns.
        """
        try:
            handle = self._timeline.simulation.robots[self._robot]
            handle.take(*set_points(Command(q, grip), handle.body))
        except CommandError as wrong:
            raise PhysicsError(f"{self._robot}: {wrong}") from wrong
        self._timeline.tick()
        self.aim.update()
        self.world = self._timeline.seen()
        self._true_for = self._true_for + 1 if self._achieved() else 0

    def observe(self) -> NDArray[np.float32]:
        """What a policy sees now; see `remac_env.backends.physics.controllers.learned.seen`."""
        return observe(self.sensing, self.aim, self.subtask.row, self.body)

    @property
    def success(self) -> bool:
        """Whether what the skill achieves by the skill table has been true for LASTING control periods on end."""
        return self._true_for >= LASTING

    @property
    def progress(self) -> float:
        """How much of the subtask is done, 0..1: for learners, judged by what the robot senses."""
        if self.success:
            return 1.0
        done = self.aim.done()
        if not self.aim.by_hand:
            return _NEARLY * done
        hand = self.aim.stand.point(self.sensing.body.grip.position)
        away = float(np.linalg.norm(self.aim.target().at - hand))
        return _NEARLY * (_BRINGING * float(np.exp(-_STEEP * away)) + (1.0 - _BRINGING) * done)

    def _achieved(self) -> bool:
        if not all(condition.holds(self._scene, self.world) for condition in self._conditions):
            return False
        return not self.subtask.row.takes or self._carried(self.subtask.target)

    def _carried(self, name: str) -> bool:
        """Whether an object that is held touches nothing but robots and other objects: its weight is the hand's."""
        simulation = self._timeline.simulation
        model, data = simulation.model, simulation.data
        body = model.body(name).id
        loose = {model.body(other).id for other in self.sensing.objects}
        own = model.body(f"{self._robot}/base").id
        for first, second in model.geom_bodyid[data.contact.geom[: data.ncon]]:
            if body in (first, second):
                other = int(second if first == body else first)
                if other not in loose and model.body_rootid[other] != own:
                    return False
        return True
