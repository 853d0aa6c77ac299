"""What a controller is: it is told a subtask, senses, and says every 50 ms what the robot is to do next.

The physics backend takes controllers by skill (``PhysicsBackend(controllers={"open door": MyController})``); every
other skill is carried out by the scripted ones. Whether a subtask succeeded is read from where everything is afterwards
and from what happened to switches and food: a controller can only give up, with a reason.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.pose import Pose
from remac_env.errors import OptionError, check_choice
from remac_env.kitchen.fixtures import FixtureReading
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.frame import WORLD, Frame
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array
from remac_env.rules.outcomes import Outcome
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState


@dataclass(frozen=True, eq=False)
class Command:
    """Set-points for one control period of 50 ms.

    ``q``: a configuration (n,), see :mod:`remac_env.robots.body`; its base is expressed in ``frame``. ``opening``:
    the travel of each finger from the middle, 0..0.04 m.
    """

    q: Array
    opening: float
    frame: Frame = WORLD


class Proprioception(Protocol):
    """What a robot feels of itself, now and without error; all in the frame of the room. Every value is a copy."""

    @property
    def q(self) -> Array:
        """The configuration (n,) in which it is."""

    @property
    def commanded(self) -> Array:
        """The set-points (n,) in force."""

    @property
    def commanded_opening(self) -> float:
        """The set-point of each finger, m."""

    @property
    def opening(self) -> float:
        """The distance between the fingertips, m."""

    @property
    def grip(self) -> Pose:
        """The pose of the point between the fingertips."""

    @property
    def push(self) -> float:
        """The force, N, with which the base pushes along the floor."""


class Sensing(Protocol):
    """What a controller knows. Poses are expressed in the frame of the room and are *as seen*.

    With ``perception_noise`` everything that is not the robot itself is seen a little off: objects, fixtures with their
    handles and switches, and slots. Errors are drawn when a subtask begins and stay as they are until the next one.
    """

    @property
    def name(self) -> str:
        """The robot."""

    @property
    def layout(self) -> Layout:
        """The floor plan, as drawn: stations, walls, and measures of fixtures."""

    @property
    def objects(self) -> Mapping[str, Category]:
        """What there is by name: sizes, shapes and how it is grasped."""

    @property
    def station(self) -> Station:
        """The robot's place, in the frame of the room."""

    @property
    def goal(self) -> Station | None:
        """Where a drive is to end, in the frame of the room; None for other skills."""

    @property
    def told(self) -> WorldState:
        """What was where, in words, when the subtask began."""

    @property
    def random(self) -> np.random.Generator:
        """For whatever a controller draws; it depends on the episode's seed and the subtask."""

    @property
    def body(self) -> Proprioception:
        """What the robot feels of itself."""

    @property
    def seconds(self) -> float:
        """Simulated time since the subtask began."""

    def pose(self, name: str) -> Pose:
        """Where an object is seen, or a part of a fixture by the name of its body, site or geom in the model.

        Raises:
            UnknownNameError: for what is not there; it lists what is.
        """

    def slot(self, name: str) -> Pose:
        """Where the middle of a slot is seen; of one in a drawer, where the drawer has it now."""

    def reading(self, fixture: str) -> FixtureReading:
        """How far doors stand open and switches are turned, which is seen without error."""

    def scan(self, angles: Array, *, height: float, farthest: float) -> Array:
        """Distances (n,), m, from the axis of the base to what is solid around it, at angles (n,) to the left of ahead.

        ``height``: over the floor, m. ``farthest``: what is said where nothing is met up to there. Without error.
        """

    def pictures(self) -> Mapping[str, NDArray[np.uint8]]:
        """What the cameras ``front``, ``wrist`` and ``side`` show, (height, width, 3); drawn when asked for.

        Raises:
            LifecycleError: where nothing draws: a backend that is used without an environment.
        """


class Controller(Protocol):
    """Carries out subtasks of one robot; made anew for each robot and episode."""

    def run(self, subtask: Subtask, sensing: Sensing) -> Generator[Command, None, Outcome]:
        """Yield a command for each control period, and return how it ended.

        A command is clipped to the maker's limits. One of the wrong length, or that is not finite, ends the subtask
        with ``invalid``, as an exception does; a controller that goes on for 60 s is ended with ``timeout``.
        """


MakeController = Callable[[], Controller]
"""Makes a controller, for one robot and one episode."""


class CommandError(Exception):
    """A command that no robot can be given; it ends the subtask and is never seen by users."""


def set_points(command: object, body: Body) -> tuple[Array, float]:
    """What a command asks of the servos: joints (n,) in the frame of the room, and finger travel, within limits.

    Raises:
        CommandError: naming what is wrong.
    """
    if not isinstance(command, Command):
        raise CommandError(f"a controller yields Command(q, opening), not {type(command).__name__}")
    try:
        q, opening = np.array(command.q, float), float(command.opening)
    except Exception as error:  # noqa: BLE001 - whatever stands there for numbers may raise anything
        raise CommandError(f"the command holds what is no number: {error}") from error
    if q.shape != body.lowest.shape:
        raise CommandError(f"the command has the shape {q.shape}; valid: {body.lowest.shape}")
    if not (all(np.isfinite(q).tolist()) and math.isfinite(opening)):
        raise CommandError(f"the command is not finite: q {q.tolist()}, opening {opening}")
    if not isinstance(command.frame, Frame):
        raise CommandError(f"the command's frame is a {type(command.frame).__name__}; valid: Frame")
    _into_room(q, command.frame)
    np.minimum(body.highest, np.maximum(body.lowest, q, out=q), out=q)
    return q, min(max(opening, 0.0), body.finger_travel)


def in_room(q: Array, frame: Frame) -> Array:
    """A configuration (n,) of a frame, in that of the room."""
    told = np.array(q, float)
    _into_room(told, frame)
    return told


def _into_room(q: Array, frame: Frame) -> None:
    """The same in place."""
    if frame is not WORLD:
        x, y, yaw = q[:3].tolist()  # Python's numbers: arithmetic on NumPy's takes ten times as long
        q[0], q[1] = frame.point(x, y)
        q[2] = yaw + frame.heading


def seen_from(q: Array, frame: Frame) -> Array:
    """A configuration (n,) of the room, in a frame."""
    told = np.array(q, float)
    x, y, yaw = told[:3].tolist()
    told[0], told[1] = frame.local(x, y)
    told[2] = yaw - frame.heading
    return told


def check_controllers(controllers: Mapping[str, MakeController], robots: int) -> None:
    """Refuse controllers for what is no skill, or for drives of several robots, which are planned together.

    Raises:
        UnknownNameError, OptionError: naming the skill and what is valid.
    """
    for skill in controllers:
        check_choice("skill with a controller", skill, [name for name, row in SKILLS.items() if not row.still])
        if robots > 1 and SKILLS[skill].moves:
            raise OptionError(f"a controller for {skill!r} knows no other robot; valid: robots=1, or none for it")
