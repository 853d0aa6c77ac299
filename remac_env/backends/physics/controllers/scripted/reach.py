"""The planner of every skill: stance x grasp x branch, the tightest pose first, all of it checked before moving."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import HELD_MARGIN
from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.motion import periods_between, smooth
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.search import CHECKS, Budget, Known, Reasons, search
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, drive_to, go_carefully, stances
from remac_env.backends.physics.controllers.scripted.verdicts import Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.pose import Pose
from remac_env.robots.rotation import Array

DISTANCES = (0.55, 0.48, 0.62, 0.70)  # m
SIDES = (0.0, -0.12, 0.12, -0.24, 0.24)  # m
_STEEP, _TURNS = (0.42, 0.48, 0.55, 0.36), (0.0, 0.3, -0.3)  # m, rad
_BETTER = 1500  # collision checks with which to look for a way that keeps clear once there is one that does not
_CLOSE = 0.003  # m around the arm where nothing else reaches into a basin
_LEANS, _LEVEL_STEP = 0.4, 0.15  # rad by which a held vessel may lean, and of a joint's turn between looks at that
_CARRYING, _CALMLY = 0.25, 0.5  # m/s, of the hand on a straight way with a vessel; share of the usual joint speeds
_CALMEST = 2  # of ways: 0, 1 where a vessel stays level, 2 where what is held keeps clear of everything too
_SET_DOWN = 0.04  # m before the goal from where a held object may come near to others

BACK = 0.10
"""By how much, m, a hand goes back from a handle that it lets go of."""

After = Callable[[Array, Grasp], Any]
"""Plans what follows from the goal configuration: something to hand on, or why nothing does (`Hit`, `NoWay`)."""


@dataclass(frozen=True)
class Reach:
    """A checked way to a grasp: where to stand, the way to the pre-grasp, the approach, and what follows."""

    base: Array
    way: Path
    approach: Path
    after: Any
    grasp: Grasp


def plan_reach(
    here: Workspace, stands: Sequence[Array], grasps: Sequence[Grasp], after: After, *, carry: Array | None = None,
    most: int = 6, checks: int = CHECKS,
) -> Reach:
    """The first free combination, or one found soon after it on which what is held stays level and clear of others.

    ``carry``: the configuration to start from instead of the folded arm. Raises SkillFailure: ``unreachable`` when no
    pose can be reached, ``blocked`` when objects are in the way.
    """
    planner, checker, why = here.clear.planner, here.clear.checker, Reasons()
    budget, known = Budget(checker, checks), Known(checker)
    tight: Reach | None = None
    steady, drive = 0, None

    def ready(base: Array) -> Array:
        return planner.body.tuck(*base) if carry is None else np.concatenate([base, carry[3:]])

    def from_here(base: Array) -> Iterator[Grasp]:
        nonlocal drive
        drive, free = None, checker.free(ready(base))
        if not free:
            why.add("stance", free)
            return
        for grasp in grasps:
            yield grasp
            if drive is not None and not drive:
                return

    def attempt(base: Array, grasp: Grasp, goal: Array) -> Reach | None:
        nonlocal tight, steady, drive
        if drive is not None and not drive:
            return None
        found = _try_goal(here, known, ready(base), goal, grasp, after, why)
        if found is None:
            return None
        if drive is None:
            drive = planner.drive(np.concatenate([here.robot.q[:3], ready(base)[3:]]), base, here.station.y)
        if not drive:
            why.add("drive", drive)
            return None
        reach, calm = _calmed(here, ready(base), Reach(base, *found, grasp))
        if calm == _CALMEST:
            return reach
        if tight is None or calm > steady:
            tight, steady = reach, calm
            budget.narrow(_BETTER)
        return None

    found = search(planner, budget, stands, from_here, attempt, ready=ready, most=most) or tight
    if found is None:
        raise why.failure()
    return found


def reach_in_slot(
    here: Workspace, kind: str, target: Array, grasps: Sequence[Grasp], after: After, *,
    awkward: Sequence[Grasp] = (), carry: Array | None = None,
) -> Reach:
    """A way to something in a slot of this ``kind``: into a basin turned, so that the forearm clears its front, at last
    with little room around the arm.

    ``target`` (3,): what to stand before. ``awkward``: grasps to be tried where there is no other way. Raises
    SkillFailure as :func:`plan_reach` does.
    """
    usual = stances(here, target, DISTANCES, SIDES)
    if kind != "basin":
        return plan_reach(here, usual, grasps, after, carry=carry)
    with suppress(SkillFailure):
        return plan_reach(here, usual, grasps, after, carry=carry, checks=CHECKS // 2)
    steep = stances(here, target, _STEEP, SIDES, _TURNS)
    every = [*grasps, *awkward]
    with suppress(SkillFailure):
        return plan_reach(here, steep, every, after, carry=carry, checks=2 * CHECKS)
    with here.clear.checker.clearance(_CLOSE, arm=True):
        return plan_reach(here, [*usual, *steep], every, after, carry=carry, checks=CHECKS)


def _try_goal(
    here: Workspace, known: Known, ready: Array, goal: Array, grasp: Grasp, after: After, why: Reasons
) -> tuple[Path, Path, Any] | None:
    planner = here.clear.planner
    failed, approach = known.get(partial(_approached, here, goal, grasp), goal, grasp.before, grasp.rotation)
    if not approach:
        why.add(failed, approach)
        return None
    following = after(goal, grasp)
    if isinstance(following, Hit | NoWay):
        why.add("after", following)
        return None
    way = planner.path(ready, approach[0], tree=False) or planner.path(ready, approach[0], via=False)
    if not way:
        why.add("no path to the pre-grasp")
        return None
    return way, approach[1:], following


def _approached(here: Workspace, goal: Array, grasp: Grasp) -> tuple[str, Path | Hit | NoWay]:
    """The way from the pose before a grasp to it, or why there is none; and what that speaks of."""
    free = here.clear.checker.free(goal)
    if not free:
        return "goal", free
    return "approach", here.clear.planner.approach(goal, grasp.first)


def _calmed(here: Workspace, ready: Array, reach: Reach) -> tuple[Reach, int]:
    """A way, or the same with straight lines where a vessel is better carried on these, and how calm it is."""
    level = _keeps_level(here, ready, reach)
    if level and _keeps_clear(here, ready, reach):
        return reach, _CALMEST
    straight = _straight(here, ready, reach) if _vessel(here) else None
    if straight is None or not _keeps_level(here, ready, straight):
        return reach, int(level)
    return straight, _CALMEST if _keeps_clear(here, ready, straight) else 1


def _vessel(here: Workspace) -> bool:
    """Whether a vessel is held."""
    held = here.clear.checker.held
    return held is not None and here.kitchen.objects[held.body].vessel


def _keeps_level(here: Workspace, ready: Array, reach: Reach) -> bool:
    """Whether a vessel that is held leans little on its way: else it turns in the fingers, and what it holds slides."""
    held = here.clear.checker.held
    if held is None or not _vessel(here):
        return True
    corners = [ready, *reach.way, *reach.approach]
    for start, end in pairwise(corners):
        for share in np.linspace(0.0, 1.0, 2 + int(np.abs(end - start)[4:].max() / _LEVEL_STEP))[1:]:
            _, rotation = here.robot.kinematics.forward(start + share * (end - start))
            if (rotation @ held.rotation)[2, 2] < math.cos(_LEANS):
                return False
    return True


def _straight(here: Workspace, ready: Array, reach: Reach) -> Reach | None:
    """The same with the hand on straight lines, which keep a vessel level: at once, from above, or from the front."""
    planner, before = here.clear.planner, reach.way[-1]
    start, there = here.robot.kinematics.forward(ready)[0], planner.hand(before)
    end = there.position
    above, aside = np.array([end[0], end[1], start[2]]), np.array([end[0], start[1], start[2]])
    low = np.array([end[0], start[1], end[2]])
    for corners in ([end], [above, end], [aside, above, end], [low, end]):
        path = [ready]
        for corner in corners:
            line = planner.line(path[-1], Pose(corner, there.rotation, there.frame), speed=_CARRYING)
            if not line:
                break
            path += line
        else:
            if planner.edge(path[-1], before):
                shares = smooth(periods_between(path[-1], before, planner.body, _CALMLY))
                turn = [path[-1] + share * (before - path[-1]) for share in shares]
                return Reach(reach.base, [], [*path[1:], *turn, *reach.approach], reach.after, reach.grasp)
    return None


def _keeps_clear(here: Workspace, ready: Array, reach: Reach) -> bool:
    """Whether what is held stays well clear of everything on the way, up to where it is set down."""
    if here.clear.checker.held is None:
        return True
    with here.clear.checker.clearance(HELD_MARGIN, gripper=False):
        return all(here.clear.planner.edge(start, end) for start, end in pairwise([ready, *reach.way])) and all(
            here.clear.checker.free(q)
            for q in reach.approach[::2]
            if np.linalg.norm(here.robot.kinematics.forward(q)[0] - reach.grasp.position) > _SET_DOWN
        )


def go_to_grasp(here: Workspace, reach: Reach, *, speed: float = 1.0) -> Steps:
    """Drive to the stance, move to the pre-grasp and approach."""
    yield from drive_to(here, reach.base)
    yield from go_carefully(here, reach.way, speed)
    yield from here.mover.play(reach.approach)


def let_go(here: Workspace, geoms: Sequence[int], opening: float) -> Steps:
    """Open the fingers to ``opening`` (m each) and go straight back from a handle, whose ``geoms`` they may touch."""
    robot, planner = here.robot, here.clear.planner
    yield from here.mover.fingers(opening, 6)
    here.begin(geoms)
    away = planner.hand(robot.q).back(BACK)
    path = planner.line(robot.q, away, weights=planner.body.door_weights) or planner.line(
        robot.q, away, weights=planner.body.door_weights, check=False
    )
    yield from here.mover.play(path or [])
    here.begin()
