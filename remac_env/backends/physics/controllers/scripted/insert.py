"""Into and out of a cavity (microwave, cabinet): the hand tilted forward, driven in and out by the base."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import TARGET
from remac_env.backends.physics.controllers.scripted.entries import Entry, grasping, level, placing
from remac_env.backends.physics.controllers.scripted.grasps import opening, squeeze
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.place import release
from remac_env.backends.physics.controllers.scripted.search import CHECKS, Budget, Reasons, search
from remac_env.backends.physics.controllers.scripted.skill import (
    EMPTY,
    SkillFailure,
    Steps,
    check_held,
    drive_to,
    go_home,
    stances,
    take,
    tuck,
)
from remac_env.backends.physics.controllers.scripted.verdicts import Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array, about_z

_DISTANCES = (0.78, 0.72, 0.84)
_SIDES = (0.0, -0.08, 0.08, -0.16, 0.16)
_TURNS = (0.0, 0.2, -0.2, 0.4, -0.4)
_BACK = 0.36  # m that the base drives in and out
_ASKEW = (0.0, 0.12, 0.25)  # rad by which the fingers may close askew on a long object, the best first
_RAISED = (0.0, 0.006, 0.010, 0.0125)  # m by which the grasp may be higher, so that the palm clears the rim of a plate
_CLEAR = (0.022,)  # m by which the object is lowered once it is in
_CLEAR_OF_RIM = (0.045, 0.034, 0.022)  # the same over a plate, the best first: too low it would push the plate
_NEARER = 0.04  # m in front of a slot's middle at which objects are put, so that they can be taken out again
_EXACT, _ITERATIONS = 0.001, 12  # m by which a hand may miss the place where it closes; steps of inverse kinematics
_WITHDRAW = 0.05  # m by which the hand draws back along its approach before the base moves


@dataclass(frozen=True)
class Insertion:
    """A checked way in: base poses outside and inside, the arm's way to its posture, and the last bit by hand."""

    outside: Array
    way: Path
    inside: Array
    last: Path


def insert(here: Workspace, point: Array, *, vessel: str | None = None) -> Steps:
    """Put the held object into an open fixture, its lowest point at ``point`` (3,), and come home."""
    body = here.hand.body
    if body is None:
        raise SkillFailure("hands_empty", "there is nothing to place")
    here.begin(here.sensed.geoms(vessel) if vessel else ())
    carry = here.robot.q.copy()
    if vessel is None:
        point = point - [0.0, _NEARER, 0.0]
    if here.kitchen.objects[body].vessel:
        entries = level(here, point)
        found = _search(here, point, carry, lambda _: entries, _lowered)
    else:
        found = _way_in(here, point, carry, body, _CLEAR if vessel is None else _CLEAR_OF_RIM)
    yield from _enter(here, found)
    check_held(here)
    yield from release(here, 10)
    away = here.clear.planner.hand(here.robot.q).back(_WITHDRAW)
    here.begin(here.sensed.geoms(body) + (here.sensed.geoms(vessel) if vessel else []))
    yield from here.mover.play(here.clear.planner.line(here.robot.q, away, speed=0.15) or [])
    yield from _leave(here, found)
    here.begin()
    yield from go_home(here)


def _way_in(here: Workspace, point: Array, carry: Array, body: str, clearances: Sequence[float]) -> Insertion:
    """A way in at the first of these clearances (m) that has one."""

    def at(clear: float) -> Insertion:
        checks = CHECKS if clear == clearances[-1] else CHECKS // 2
        return _search(here, point, carry, partial(placing, here, body, point, clear), _lowered, checks)

    return _first([partial(at, clear) for clear in clearances])


def take_out(here: Workspace, body: str, *, vessel: str | None = None) -> Steps:
    """Grasp ``body`` inside an open fixture, on or in ``vessel`` there, bring it out and come home."""
    here.begin()
    yield from tuck(here)
    obj = here.kitchen.objects[body]
    here.robot.grip = opening(obj, here.robot.body)
    here.begin(here.sensed.geoms(body))
    stood = here.sensed.pose(body)
    found = _way_to(here, obj, stood, vessel)
    yield from _enter(here, found)
    yield from here.mover.settle(0.001, 20)
    yield from here.mover.grasp(squeeze(obj, here.robot.body))
    yield from here.mover.play(_up(here))
    if here.robot.opening < EMPTY:
        yield from here.mover.fingers(opening(obj, here.robot.body), 6)
        yield from _leave(here, found)
        raise SkillFailure("slipped", f"the {body} did not come with the hand")
    take(here, body, stood, ())
    yield from _leave(here, found)
    yield from go_home(here)


def _way_to(here: Workspace, obj: Category, pose: Pose, vessel: str | None) -> Insertion:
    """A way to a grasp square to the object, else askew; clear of the vessel that it lies in, else over its rim."""
    carry = here.robot.body.tuck(*here.robot.q[:3])
    rims: list[list[int]] = [[]] if vessel is None else [[], here.sensed.geoms(vessel)]
    turns = _ASKEW if obj.grasp.mode == "side" and not obj.grasp.any_yaw else (0.0,)

    def over(rim: list[int], askew: float) -> Insertion:
        here.clear.checker.mark(rim, TARGET)
        poses = partial(grasping, obj, here.robot.body, pose, _RAISED[::-1] if rim else _RAISED, askew)
        return _search(here, pose.position, carry, poses, _advanced, CHECKS if rim is rims[-1] else CHECKS // 2)

    return _first([partial(over, rim, askew) for rim, askew in product(rims, turns)])


def _first(searches: Sequence[Callable[[], Insertion]]) -> Insertion:
    """What the first of these searches finds that finds anything; fails as the last of them does."""
    *better, last = searches
    for find in better:
        with suppress(SkillFailure):
            return find()
    return last()


def _up(here: Workspace) -> Path:
    """Off the floor, over the rim of a plate where there is room for the hand."""
    hand = here.clear.planner.hand(here.robot.q)
    for rise in (0.05, 0.04, 0.03):
        up = here.clear.planner.line(here.robot.q, hand.shifted([0.0, 0.0, rise]), speed=0.1)
        if up:
            return up
    return here.clear.planner.line(here.robot.q, hand.shifted([0.0, 0.0, 0.025]), speed=0.1, check=False) or []


Last = Callable[[Workspace, Array, Entry], Path | Hit | NoWay]
"""The last bit by hand, from a configuration inside."""


def _search(
    here: Workspace, point: Array, carry: Array, poses: Callable[[Array], Iterable[Entry]], last: Last,
    checks: int = CHECKS,
) -> Insertion:
    """The first stance, tilt and branch whose whole way in is free. Raises SkillFailure where there is none."""
    planner, checker, why = here.clear.planner, here.clear.checker, Reasons()

    def attempt(base: Array, entry: Entry, q: Array) -> Insertion | None:
        outside = base.copy()
        outside[:2] -= _BACK * about_z(float(base[2]))[:2, 0]
        retreated = np.concatenate([outside, q[3:]])
        free = checker.free(q) and checker.free(retreated) and planner.edge(retreated, q, 0.06)
        if not free:
            why.add("inside", free)
            return None
        final = last(here, q, entry)
        if not final:
            why.add("last bit", final)
            return None
        way = planner.path(np.concatenate([outside, carry[3:]]), retreated)
        drive = way and planner.drive(carry, outside, here.station.y)
        if not way or not drive:
            why.add("no way to the front", drive)
            return None
        return Insertion(outside, way, q, final)

    stands, budget = stances(here, point, _DISTANCES, _SIDES, _TURNS), Budget(checker, checks)
    found = search(
        planner, budget, stands, poses, attempt, ready=lambda base: np.concatenate([base, carry[3:]]), most=5
    )
    if found is None:
        raise why.failure()
    return found


def _lowered(here: Workspace, q: Array, entry: Entry) -> Path | Hit | NoWay:
    return here.clear.planner.line(q, entry.last, speed=0.1, check=False)


def _advanced(here: Workspace, q: Array, entry: Entry) -> Path | Hit | NoWay:
    """A straight way that ends just there: pads that close a few mm too high squeeze a round object out."""
    path = here.clear.planner.line(q, entry.last, speed=0.12)
    if not path:
        return path
    step = here.clear.planner.step
    there = here.robot.kinematics.track(path[-1], entry.end, entry.rotation, iterations=_ITERATIONS, largest=step)
    if there.position_error > _EXACT:
        return NoWay("the arm does not reach the very place")
    return [*path, there.q]


def _enter(here: Workspace, found: Insertion) -> Steps:
    yield from drive_to(here, found.outside)
    yield from here.mover.go(found.way, 0.6)
    yield from here.mover.go([found.inside], 0.5)
    yield from here.mover.play(found.last)


def _leave(here: Workspace, found: Insertion) -> Steps:
    out = here.robot.q.copy()
    out[:3] = found.outside
    yield from here.mover.go([out], 0.8)
