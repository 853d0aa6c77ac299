"""Into and out of a cavity (microwave, cabinet): the hand tilted forward, driven in and out by the base."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import TARGET
from remac_env.backends.physics.controllers.scripted.grasps import OPENINGS, squeeze, tip_depth
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.place import release, upright_poses
from remac_env.backends.physics.controllers.scripted.skill import (
    EMPTY,
    SkillFailure,
    Steps,
    Surroundings,
    check_held,
    drive_to,
    go_home,
    lowest,
    stances,
    take,
    tuck,
)
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots import panda
from remac_env.robots.rotation import Array, about_z, grip_frame

_DISTANCES = (0.78, 0.72, 0.84)
_SIDES = (0.0, -0.08, 0.08, -0.16, 0.16)
_TURNS = (0.0, 0.2, -0.2, 0.4, -0.4)
_TILTS = (0.45, 0.3, 0.6, 0.8)  # of the hand below the horizontal
_GRASP_TILTS = (0.6, 0.7, 0.8, 0.53, 0.45, 1.0, 0.3)
_BACK = 0.36  # m that the base drives in and out
_CHECKS = 9000
_ASKEW = (0.0, 0.12, 0.25)  # rad by which the fingers may close askew on a long thing, the best first
_RAISED = (0.0, 0.006, 0.010, 0.0125)  # m by which the grasp may be higher, so that the palm clears the rim of a plate
_HOLD = 0.005  # m by which the pads must reach below a thing's middle, with the air that tip_depth adds
_PALM = 0.028  # m between grip site and palm, less a little
_PAD = 0.012  # m to either side of a grasp's middle that the fingers hold along a thing, about
_WIDEST_TURN = 1.25  # rad to the side from which a hand still fits into a cavity
_CLEAR = (0.022,)  # m by which the thing is lowered once it is in
_CLEAR_OF_RIM = (0.045, 0.034, 0.022)  # the same over a plate, the best first: too low it would push the plate
_CLEAR_OF_FLOOR = 0.03  # the same for a vessel itself
_TOUCH = 0.003  # m between the thing's lowest point and the floor where the hand opens
_FORWARD = 0.03  # m by which a thing let go on end moves on as it falls
_NEARER = 0.04  # m in front of a slot's middle at which things are put, so that they can be taken out again
_WITHDRAW = 0.05  # m by which the hand draws back along its approach before the base moves


@dataclass(frozen=True)
class Insertion:
    """A checked way in: base poses outside and inside, the arm's way to its posture, and the last bit by hand."""

    outside: Array
    way: Path
    inside: Array
    last: Path


def insert(here: Surroundings, point: Array, *, vessel: str | None = None) -> Steps:
    """Put the held thing into an open fixture, its lowest point at ``point`` (3,), and come home."""
    body = here.hand.body
    if body is None:
        raise SkillFailure("hands_empty", "there is nothing to place")
    here.begin(here.simulation.geoms(vessel) if vessel else ())
    carry = here.robot.q.copy()
    if vessel is None:
        point = point - [0.0, _NEARER, 0.0]
    if here.things[body].vessel:
        level = _level(here, point)
        found = _search(here, point, carry, lambda _: level, _lowered)
    else:
        found = _way_in(here, point, carry, body, _CLEAR if vessel is None else _CLEAR_OF_RIM)
    yield from _enter(here, found)
    check_held(here)
    yield from release(here, 10)
    position, rotation = here.kinematics.forward(here.robot.q)
    away = position - _WITHDRAW * rotation[:, 2]
    here.begin(here.simulation.geoms(body) + (here.simulation.geoms(vessel) if vessel else []))
    yield from here.mover.play(here.planner.line(here.robot.q, away, rotation, speed=0.15) or [])
    yield from _leave(here, found)
    here.begin()
    yield from go_home(here)


def _way_in(here: Surroundings, point: Array, carry: Array, body: str, clearances: Sequence[float]) -> Insertion:
    """A way in at the first of these clearances (m) that has one."""

    def search(clear: float) -> Insertion:
        checks = _CHECKS if clear == clearances[-1] else _CHECKS // 2
        return _search(here, point, carry, partial(_placing, here, body, point, clear), _lowered, checks)

    return _first([partial(search, clear) for clear in clearances])


def take_out(here: Surroundings, body: str, *, vessel: str | None = None) -> Steps:
    """Grasp ``body`` inside an open fixture, on or in ``vessel`` there, bring it out and come home."""
    here.begin()
    yield from tuck(here)
    thing = here.things[body]
    opening = OPENINGS[thing.grasp.mode]
    here.robot.grip = opening
    here.begin(here.simulation.geoms(body))
    position, rotation = here.simulation.pose(body)
    found = _way_to(here, thing, position, rotation, vessel)
    yield from _enter(here, found)
    yield from here.mover.settle(0.001, 20)
    yield from here.mover.grasp(squeeze(thing))
    yield from here.mover.play(_up(here))
    if here.robot.opening < EMPTY:
        yield from here.mover.fingers(opening, 6)
        yield from _leave(here, found)
        raise SkillFailure("slipped", f"the {body} did not come with the hand")
    take(here, body, rotation, ())
    yield from _leave(here, found)
    yield from go_home(here)


def _way_to(
    here: Surroundings, thing: Category, position: Array, rotation: Array, vessel: str | None
) -> Insertion:
    """A way to a grasp square to the thing, else askew; clear of the vessel that it lies in, else over its rim."""
    carry = panda.tucked(*here.robot.q[:3])
    rims: list[list[int]] = [[]] if vessel is None else [[], here.simulation.geoms(vessel)]
    turns = _ASKEW if thing.grasp.mode == "side" and not thing.grasp.any_yaw else (0.0,)

    def search(rim: list[int], askew: float) -> Insertion:
        here.scratch.mark(rim, TARGET)
        poses = partial(_grasping, thing, position, rotation, _RAISED[::-1] if rim else _RAISED, askew)
        return _search(here, position, carry, poses, _advanced, _CHECKS if rim is rims[-1] else _CHECKS // 2)

    return _first([partial(search, rim, askew) for rim, askew in product(rims, turns)])


def _first(searches: Sequence[Callable[[], Insertion]]) -> Insertion:
    """What the first of these searches finds that finds anything; fails as the last of them does."""
    *better, last = searches
    for search in better:
        with suppress(SkillFailure):
            return search()
    return last()


def _up(here: Surroundings) -> Path:
    """Off the floor, over the rim of a plate where there is room for the hand."""
    position, rotation = here.kinematics.forward(here.robot.q)
    for rise in (0.05, 0.04, 0.03):
        up = here.planner.line(here.robot.q, position + [0.0, 0.0, rise], rotation, speed=0.1)
        if up is not None:
            return up
    return here.planner.line(here.robot.q, position + [0.0, 0.0, 0.025], rotation, speed=0.1, check=False) or []


Poses = Callable[[Array], Iterable[tuple[Array, Array, Array]]]


def _search(
    here: Surroundings, point: Array, carry: Array, poses: Poses, last: Callable[..., Path | None],
    checks: int = _CHECKS,
) -> Insertion:
    """The first stance, tilt and branch whose whole way in is free. ``poses`` yields (first, end, rotation)."""
    planner, scratch = here.planner, here.scratch
    why: Counter[str] = Counter()
    limit = scratch.limit(checks)
    for base in stances(here, point, _DISTANCES, _SIDES, _TURNS):
        heading = about_z(float(base[2]))[:, 0]
        outside = base.copy()
        outside[:2] -= _BACK * heading[:2]
        for first, end, rotation in poses(base):
            if scratch.checks > limit:
                break
            for q in planner.reach(first, rotation, base, np.concatenate([base, carry[3:]]), most=5):
                retreated = np.concatenate([outside, q[3:]])
                if not scratch.free(q) or not scratch.free(retreated) or not planner.edge(retreated, q, 0.06):
                    why["inside: {} meets {}".format(*scratch.touching)] += 1
                    continue
                final = last(here, q, end, rotation)
                if final is None:
                    why["last bit: " + planner.reason] += 1
                    continue
                way = planner.path(np.concatenate([outside, carry[3:]]), retreated)
                if way is None or planner.drive(carry, outside, here.station.y) is None:
                    why["no way to the front: {} meets {}".format(*scratch.touching)] += 1
                    continue
                return Insertion(outside, way, q, final)
    raise SkillFailure("blocked" if why else "unreachable", "; ".join(f"{t} ({n})" for t, n in why.most_common(3)))


def _lowered(here: Surroundings, q: Array, end: Array, rotation: Array) -> Path | None:
    return here.planner.line(q, end, rotation, speed=0.1, check=False)


def _advanced(here: Surroundings, q: Array, end: Array, rotation: Array) -> Path | None:
    return here.planner.line(q, end, rotation, speed=0.12)


def _enter(here: Surroundings, found: Insertion) -> Steps:
    yield from drive_to(here, found.outside)
    yield from here.mover.go(found.way, 0.6)
    yield from here.mover.go([found.inside], 0.5)
    yield from here.mover.play(found.last)


def _leave(here: Surroundings, found: Insertion) -> Steps:
    out = here.robot.q.copy()
    out[:3] = found.outside
    yield from here.mover.go([out], 0.8)


def _placing(
    here: Surroundings, body: str, point: Array, clear: float, base: Array
) -> Iterator[tuple[Array, Array, Array]]:
    """Hand poses that bring the held thing in over ``point``: (while driving in, at the release, rotation).

    Those come first in which the thing is nearly as it will lie, so that it does not topple.
    """
    grip, pose = here.robot.grip_pose(), here.simulation.pose(body)
    inward = grip[1].T
    offset, turned = inward @ (pose[0] - grip[0]), inward @ pose[1]
    heading = about_z(float(base[2]))
    found: list[tuple[float, int, Array, float]] = []
    for tilt in _TILTS:
        for side in (-heading[:, 1], heading[:, 1]):
            hand = grip_frame(heading[:, 0] * math.cos(tilt) - np.array([0.0, 0.0, math.sin(tilt)]), side)
            fall = _fall(here.things[body], hand @ turned)
            found.append((round(abs(fall) + 0.2 * abs(tilt - _TILTS[0]), 6), len(found), hand, fall))
    for _, _, hand, fall in sorted(found, key=lambda entry: entry[:2]):
        below = lowest(here, body, hand @ turned)
        shift = -hand @ offset
        height = max(point[2] + below + _TOUCH, point[2] + 0.03 - shift[2])
        at = np.array([point[0], point[1], height]) + shift - _FORWARD * abs(math.sin(fall)) * heading[:, 0]
        yield at + [0.0, 0.0, clear], at, hand


def _level(here: Surroundings, point: Array) -> list[tuple[Array, Array, Array]]:
    """Hand poses that bring a vessel in level over ``point``: (while driving in, at the release, rotation)."""
    grasps = upright_poses(here, point, "cavity")
    return [(grasp.position + [0.0, 0.0, _CLEAR_OF_FLOOR], grasp.position, grasp.rotation) for grasp in grasps]


def _fall(thing: Category, rotation: Array) -> float:
    """How far a thing turned so is from lying or standing (rad)."""
    if thing.rest_height > 0.01:
        return math.asin(min(1.0, abs(float(rotation[2, 0]))))
    tilt = math.acos(min(1.0, abs(float(rotation[2, 2]))))
    return min(tilt, 0.5 * math.pi - tilt)


def _grasping(
    thing: Category, position: Array, rotation: Array, raised: Sequence[float], askew: float, base: Array
) -> Iterator[tuple[Array, Array, Array]]:
    """Hand poses that grasp a thing from the front, ``askew`` rad at most: (before, at the grasp, rotation)."""
    heading = float(base[2])
    turns: tuple[float, ...] = (0.0, 0.3, -0.3, 0.6, -0.6)
    if thing.grasp.mode == "side" and not thing.grasp.any_yaw:
        along = math.atan2(rotation[1, 0], rotation[0, 0])
        along = (along - heading + 0.5 * math.pi) % math.pi - 0.5 * math.pi
        # Square to the thing, or nearer to square to the cavity, for the hand is wide.
        turns = (along - math.copysign(min(askew, abs(along)), along),)
    for higher, tilt in product(raised, _GRASP_TILTS):
        for yaw in turns:
            if abs(yaw) > _WIDEST_TURN:
                continue
            front = about_z(heading + yaw)
            for side in (-front[:, 1], front[:, 1]):
                approach = front[:, 0] * math.cos(tilt) - np.array([0.0, 0.0, math.sin(tilt)])
                hand = grip_frame(approach, side)
                height = max(thing.grasp.height, tip_depth(0.5 * math.pi - tilt) - thing.rest_height)
                # A long thing lies along the hand: take it nearer, or its end would meet the palm.
                height += higher
                if higher and height > tip_depth(0.5 * math.pi - tilt) - _HOLD:
                    continue
                spare = (_PALM + height * math.sin(tilt)) / math.cos(tilt)
                nearer = min(max(0.0, thing.size[0] - spare), 0.6 * thing.size[0])
                at = position + [0.0, 0.0, height] - nearer * front[:, 0]
                aside, turned = _bent(thing, -nearer * front[:, 0] @ rotation)
                at, hand = at + rotation @ aside, about_z(turned) @ hand
                approach = hand[:, 2]
                yield at + [0.0, 0.0, 0.03] - 0.04 * approach, at, hand


def _bent(thing: Category, at: Array) -> tuple[Array, float]:
    """How far (3,) beside its axis a bent thing's middle line is at ``at`` in its frame, and its turn there (rad)."""
    if thing.body.form != "chain":
        return np.zeros(3), 0.0
    x, y, _ = np.array(thing.body["points"]).T
    ahead, behind = (float(np.interp(at[0] + end, x, y)) for end in (_PAD, -_PAD))
    return np.array([0.0, 0.5 * (ahead + behind), 0.0]), math.atan2(ahead - behind, 2.0 * _PAD)
