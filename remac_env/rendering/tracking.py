"""Cameras of videos: one that follows the robots, so that their work fills the picture, and a close one for each hand.

They stand still while what they show stays in a picture that is not much wider than it has to be, and then move on to
where the next such shot is taken from: films that tremble with every joint are hard to watch, and ten times larger.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import cos, radians, sin
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.fixtures.base import WALL_Y
from remac_env.rendering.cameras import CLOSE, FIELD, FOLLOW, STEEP, WHOLE_FIELD, WIDE_ASPECT, axes, fitted
from remac_env.rendering.following import facing_of

if TYPE_CHECKING:
    import mujoco

    from remac_env.kitchen.floor_plan import Layout

Floats = NDArray[np.float64]

_UP = np.array([0.0, 0.0, 1.0])
_BACK = np.array([0.0, -cos(radians(STEEP)), sin(radians(STEEP))])  # from the open side of the room
_HALF, _TOP = 0.40, 1.50  # m: a robot's base to either side, and its arm's height
_AHEAD, _WORK = 0.75, (0.75, 1.55)  # m before a robot's middle, and the heights there, of what it works at
_FRAMED = 0.94  # of the picture
_NEAREST = 1.6  # m from the followed robots
_HAND = 0.14  # m around the hand: what it holds, and what that is put on
_CLOSE_FRAMED, _CLOSE_NEAREST = 0.80, 0.42
_SIDE, _BEHIND, _ABOVE = 0.80, -0.40, 0.62  # from the hand to its camera: to the side, back and up, as the robot faces
_GAP = 0.15  # m from a camera to walls
_WIDER = 1.25  # times as far away as one moment of a shot wants its camera, the others may want it
_WANDERS = 0.25  # m that a hand may be from the middle of where it is in a shot
_STILL = 0.03  # m: who moves less than this is taken for one that waits,
_WAITS = 12  # frames before and after, in a video of 15 a second
_EVEN = 6  # frames before and after one over which a camera moves on, in a video of 15 a second


@dataclass(frozen=True)
class Seen:
    """What is to be in the pictures of one moment, world frame, m.

    work: robot -> corners of it and of what it may work at, its hand's middle last, (n, 3). hands: robot -> its hand's
    middle, (3,). backs: robot -> the direction from its hand to its camera, (3,), a unit.
    """

    work: Mapping[str, Floats]
    hands: Mapping[str, Floats]
    backs: Mapping[str, Floats]


@dataclass(frozen=True)
class Aim:
    """Where a camera stands, (3,), m, and the direction away from what it looks at, (3,), a unit; world frame."""

    place: Floats
    back: Floats


def look(data: mujoco.MjData, layout: Layout, robots: Sequence[str]) -> Seen:
    """What is to be seen in a pose whose positions have been computed."""
    hands = {robot: data.body(f"{robot}/hand").xpos.copy() for robot in robots}
    backs = {robot: _over_shoulder(hands[robot], layout, facing_of(data, robot)) for robot in robots}
    work = {robot: np.array([*_corners(data, robot), hands[robot]]) for robot in robots}
    return Seen(work, hands, backs)


def aimed(moments: Sequence[Seen], layout: Layout) -> list[dict[str, Aim]]:
    """For each moment of a film, camera -> its aim.

    Robots at work, and what they work at, are in every picture of FOLLOW; so are those that only wait where all do.
    """
    if not moments:
        return []
    cameras = {FOLLOW: _following([moment.work for moment in moments])}
    for robot in moments[0].hands:
        hands = np.array([moment.hands[robot] for moment in moments])
        cameras[CLOSE.format(robot=robot)] = _close(hands, np.array([m.backs[robot] for m in moments]), layout)
    return [{name: aims[index] for name, aims in cameras.items()} for index in range(len(moments))]


def place(data: mujoco.MjData, aims: Mapping[str, Aim]) -> None:
    """Put the cameras there."""
    for name, aim in aims.items():
        camera = data.camera(name)
        camera.xpos[:] = aim.place
        camera.xmat[:] = axes(aim.back, _UP).ravel()


def _corners(data: mujoco.MjData, robot: str) -> Iterator[Floats]:
    base, facing = data.body(f"{robot}/base").xpos * (1.0, 1.0, 0.0), facing_of(data, robot)
    for corner in product((-_HALF, _HALF), (-_HALF, _HALF), (0.0, _TOP)):
        yield base + np.array(corner)
    for side, height in product((-_HALF, _HALF), _WORK):
        yield base + _AHEAD * facing[:, 1] + side * facing[:, 0] + height * _UP


def _over_shoulder(hand: Floats, layout: Layout, facing: Floats) -> Floats:
    """Over the robot's shoulder, from the side on which there is more room."""
    left, right = layout.room.x
    middle = np.array([(left + right) / 2, -1.0, hand[2]])
    side = 1.0 if float((middle - hand) @ facing[:, 0]) >= 0.0 else -1.0
    return _unit(facing @ np.array([side * _SIDE, _BEHIND, _ABOVE]))


def _following(robots: Sequence[Mapping[str, Floats]]) -> list[Aim]:
    """As near as the camera can be while all who are at work are in the picture.

    The places from which a point is in the picture, for one direction of view, are convex. Each place chosen here also
    shows what is at work just before and after its moment; so the mean of places near in time shows all of its own.
    """
    turn = axes(_BACK, _UP)
    busy = [_busy(robots, at) for at in range(len(robots))]
    work = [np.concatenate([points[name] for name in names]) for points, names in zip(robots, busy, strict=True)]

    def eye(first: int, end: int) -> Floats:
        points = np.concatenate(work[max(0, first) : end])
        return fitted(points, turn, WHOLE_FIELD, aspect=WIDE_ASPECT, framed=_FRAMED, near=_NEAREST)

    away = [float(eye(index, index + 1) @ _BACK - (work[index] @ _BACK).max()) for index in range(len(work))]

    def fits(first: int, end: int) -> bool:
        # A long shot is not to be as wide as those just before it, in which others were at work.
        if end - first > _EVEN and len(set(busy[max(0, first - _EVEN) : end + _EVEN])) > 1:
            return False
        points = np.concatenate(work[first:end])
        return float(eye(first, end) @ _BACK - (points @ _BACK).max()) <= _WIDER * min(away[first:end])

    places = [
        place
        for first, end in _shots(len(work), fits)
        for place in [eye(first - _EVEN, end + _EVEN)] * (end - first)
    ]  # fmt: skip
    return [Aim(place, _BACK) for place in _evened(places)]


def _busy(robots: Sequence[Mapping[str, Floats]], at: int) -> tuple[str, ...]:
    """The robots that move just before or after a moment; all where none does."""
    around, now = robots[max(0, at - _WAITS) : at + _WAITS + 1], robots[at]
    moved = {name: max(float(np.abs(moment[name] - now[name]).max()) for moment in around) for name in now}
    return tuple(name for name, by in moved.items() if by > _STILL) or tuple(now)


def _close(hands: Floats, backs: Floats, layout: Layout) -> list[Aim]:
    """Each shot from near the middle of where the hand is in it."""

    def fits(first: int, end: int) -> bool:
        return float(np.linalg.norm(hands[first:end] - _middle(hands[first:end]), axis=1).max()) <= _WANDERS

    places, targets = [], []
    around = np.array([_HAND * np.array(corner) for corner in product((-1.0, 1.0), repeat=3)])
    left, right = layout.room.x
    for first, end in _shots(len(hands), fits):
        points = (hands[first:end, None] + around).reshape(-1, 3)
        turn = axes(_unit(backs[first:end].mean(axis=0) + 1e-6 * backs[first]), _UP)
        eye = fitted(points, turn, FIELD, framed=_CLOSE_FRAMED, near=_CLOSE_NEAREST)
        eye = np.array([min(max(eye[0], left + _GAP), right - _GAP), min(eye[1], WALL_Y - _GAP), eye[2]])
        places += [eye] * (end - first)
        targets += [_middle(hands[first:end])] * (end - first)
    return [Aim(at, _unit(at - target)) for at, target in zip(_evened(places), _evened(targets), strict=True)]


def _shots(count: int, fits: Callable[[int, int], bool]) -> Iterator[tuple[int, int]]:
    """Moments in a row that one shot shows, as (first, end), each as long as it can be."""
    first = 0
    for end in range(1, count + 1):
        if end == count or not fits(first, end + 1):
            yield first, end
            first = end


def _evened(places: Sequence[Floats]) -> list[Floats]:
    """Each the mean of those around it: a camera moves on and does not leap."""
    return [np.mean(places[max(0, at - _EVEN) : at + _EVEN + 1], axis=0) for at in range(len(places))]


def _middle(points: Floats) -> Floats:
    return (points.min(axis=0) + points.max(axis=0)) / 2


def _unit(vector: Floats) -> Floats:
    return vector / np.linalg.norm(vector)
