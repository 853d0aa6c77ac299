"""Collision-free motion of one robot: joint paths, straight lines of the hand, short drives.

Everything is a list of configurations (n,); nothing here moves the simulated robot. Searches are bounded by counts
and draw from a generator that the caller seeds, so results never depend on the clock.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.controllers.scripted.collision import TRANSIT_MARGIN, CollisionChecker
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit, NoWay
from remac_env.backends.physics.pose import Pose
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.robots.rotation import Array, from_rotation_vector, rotation_vector

Path = list[Array]

_DENSE = 0.0125  # rad between looks at a tight way: usually the hand moves by more between two than it keeps clear

_TREE_ROUNDS = 300
_TREE_STEP = 0.35
_TREE_CHECKS = 6000
_LIFT_SCALE = 4.0  # rad/m: what the lift counts beside the arm's joints
_ESCAPES = ((-0.05, 0.0), (-0.10, 0.0), (0.0, 0.05), (-0.2, 0.05), (-0.3, 0.0))  # base back, torso up (m)


class Planner:
    """Plans for the robot of ``checker``. ``random`` is used by the tree search only."""

    def __init__(self, checker: CollisionChecker, random: np.random.Generator) -> None:
        self.checker, self.random = checker, random
        self.robot = checker.robot
        self.kinematics, self.body = checker.robot.kinematics, checker.robot.body
        self._scale = np.array([0.0, 0.0, 0.0, _LIFT_SCALE, *[1.0] * len(self.body.folded)])
        self.step = self.body.speed * CONTROL_PERIOD * 1.5  # largest change of a joint in one control period

    # -- joint space -----------------------------------------------------------------------------------------

    def edge(
        self, a: Array, b: Array, step: float = 0.05, joints: Mapping[int, float] | None = None,
        *, sure: Callable[[Array], NDArray[np.bool_]] | None = None,
    ) -> Free | Hit:
        """Whether the straight joint motion from ``a`` (known free) to ``b`` is free.

        ``sure``: tells of configurations (t, n) between, quickly, which are surely free.
        """
        change = np.abs(b - a)
        count = max(1, math.ceil(max(change[4:].max(), change[:4].max() * 2.5) / step))
        # The ends of ever smaller halves first: a hit shows early.
        moments = sorted(range(1, count + 1), key=lambda k: -(k & -k))
        if sure is not None:
            safe = sure(a + (b - a) * (np.array(moments) / count)[:, None])
            moments = [k for k, free in zip(moments, safe, strict=True) if not free or k == count]
        for k in moments:
            free = self.checker.free(a + (b - a) * (k / count), joints)
            if not free:
                return free
        return FREE

    def path(self, a: Array, b: Array, *, via: bool = True, tree: bool = True) -> Path | Hit:
        """Way points after ``a`` up to ``b`` with the base still, clear of objects; where that is impossible, tight.

        What was met last, where there is no way.
        """
        with self.checker.clearance(TRANSIT_MARGIN):
            found = self.checker.free(a) and self.checker.free(b) and self._path(a, b, via, tree)
        if found:
            return found
        tight = self._path(a, b, via, tree)
        for one, other in pairwise([a, *tight] if tight else ()):
            free = self.edge(one, other, _DENSE)
            if not free:
                return free
        return tight

    def _path(self, a: Array, b: Array, via: bool, tree: bool) -> Path | Hit:
        end = self.checker.free(b)
        if not end:
            return end
        start = self.checker.free(a)
        if not start:
            return self._escape(a, b, start)
        free = self.edge(a, b)
        if free:
            return [b]
        if via:
            for arm in self.body.via:
                for torso in (a[3], b[3], min(0.3, self.body.upper[3])):
                    middle = np.concatenate([a[:3], [torso], arm])
                    free = self.checker.free(middle) and self.edge(a, middle) and self.edge(middle, b)
                    if free:
                        return [middle, b]
        return self._tree(a, b, free) if tree else free

    def _escape(self, a: Array, b: Array, met: Hit) -> Path | Hit:
        """From a start inside the margins (just released something): back or up a little, then on."""
        heading = np.array([math.cos(a[2]), math.sin(a[2])])
        for back, up in _ESCAPES:
            c = a.copy()
            c[:2] += back * heading
            c[3] = min(c[3] + up, self.body.upper[3])
            clear = self.checker.free(c)
            if not clear:
                met = clear
                continue
            end = b.copy()
            end[:3] = c[:3]
            rest = self.checker.free(end) and self._path(c, end, True, True)
            if not isinstance(rest, Hit):
                return [c, *rest]
            met = rest
        return met

    def _tree(self, a: Array, b: Array, met: Hit) -> Path | Hit:
        """RRT-connect over torso and arm, shortened."""
        lower, upper = self.body.lower.copy(), self.body.upper.copy()
        lower[:3] = upper[:3] = a[:3]
        near, far = _Tree(a), _Tree(b)
        limit = self.checker.checks + _TREE_CHECKS
        for _ in range(_TREE_ROUNDS):
            if self.checker.checks > limit:
                break
            goal = far.nodes[0] if self.random.random() < 0.2 else self.random.uniform(lower, upper)
            reached = self._extend(near, goal)
            while not isinstance(reached, Hit):
                meeting = self._extend(far, reached)
                if isinstance(meeting, Hit):
                    met = meeting
                    break
                if np.abs(meeting - reached).max() < 1e-9:
                    joined = near.branch()[::-1] + far.branch()[1:]
                    if np.abs(joined[0] - a).max() > 1e-9:
                        joined = joined[::-1]
                    return self._shortened(joined)[1:]
            if isinstance(reached, Hit):
                met = reached
            near, far = far, near
        return met

    def _extend(self, tree: _Tree, goal: Array) -> Array | Hit:
        nodes = np.array(tree.nodes)
        nearest = int(np.argmin((((nodes - goal) * self._scale) ** 2).sum(axis=1)))
        change = goal - nodes[nearest]
        length = float(np.linalg.norm(change * self._scale))
        reached = goal if length <= _TREE_STEP else nodes[nearest] + change * (_TREE_STEP / length)
        free = self.edge(nodes[nearest], reached, 0.07)
        if not free:
            return free
        tree.add(reached, nearest)
        return reached

    def _shortened(self, path: Path) -> Path:
        for _ in range(40):
            if len(path) < 3:
                break
            i = int(self.random.integers(0, len(path) - 2))
            j = int(self.random.integers(i + 2, len(path)))
            if self.edge(path[i], path[j]):
                path = path[: i + 1] + path[j:]
        return path

    # -- straight lines of the hand --------------------------------------------------------------------------

    def line(
        self, q: Array, end: Pose, *, speed: float = 0.2, turn_speed: float = 1.5,
        weights: Array | None = None, check: bool = True, joints: Mapping[int, float] | None = None,
    ) -> Path | Hit | NoWay:
        """One configuration per control period along the straight line from ``q`` to a pose, or why there is none.

        ``speed`` in m/s, ``turn_speed`` in rad/s. Without ``check`` contacts are not looked at.
        """
        end.expressed_in(self.robot.frame)
        position, rotation = end.position, end.rotation
        start, turned = self.kinematics.forward(q)
        weights = self.body.arm_weights if weights is None else weights
        turn = rotation_vector(rotation @ turned.T)
        seconds = max(np.linalg.norm(position - start) / speed, np.linalg.norm(turn) / turn_speed) * 1.2
        count = max(2, math.ceil(seconds / CONTROL_PERIOD))
        path: Path = []
        error = turn_error = 0.0
        for k in range(1, count + 1):
            u = k / count
            u = 0.5 * (u * u * (3 - 2 * u) + u)
            at = from_rotation_vector(u * turn) @ turned
            tracked = self.kinematics.track(q, start + u * (position - start), at, weights=weights, largest=self.step)
            q, error, turn_error = tracked.q, tracked.position_error, tracked.rotation_error
            path.append(q)
            if error > 0.01 or turn_error > 0.06:
                return NoWay("the arm cannot follow the line")
            free = self.checker.free(q, joints) if check and (k % 2 == 0 or k == count) else FREE
            if not free:
                return free
        if error > 0.004 or turn_error > 0.04:
            return NoWay("the arm does not reach the end of the line")
        return path

    def hand(self, q: Array) -> Pose:
        """The pose of the hand in configuration ``q`` (n,)."""
        return Pose(*self.kinematics.forward(q), self.robot.frame)

    def approach(self, goal: Array, start: Pose, *, speed: float = 0.15) -> Path | Hit | NoWay:
        """Configurations from a pre-grasp to ``goal``, tracked backwards from the tightest pose."""
        back = self.line(goal, start, speed=speed)
        return [*back[::-1], goal] if back else back

    # -- the base --------------------------------------------------------------------------------------------

    def drive(self, a: Array, base: Array, lane: float) -> Path | Hit:
        """Way points from ``a`` with its arm as it is to a base pose (3,): straight, else by way of y = ``lane``."""
        goal = a.copy()
        goal[:3] = base
        out, along, back = a.copy(), goal.copy(), a.copy()
        out[1] = min(a[1], lane)
        along[1] = min(goal[1], lane)
        back[1], back[2] = out[1], base[2]
        met: Path | Hit = []
        for way in ([goal], [out, along, goal], [out, back, along, goal]):
            free = self._along([a, *way])
            if free:
                return way
            met = free
        return met

    def _along(self, corners: Path) -> Free | Hit:
        for one, other in pairwise(corners):
            free = self.edge(one, other)
            if not free:
                return free
        return FREE

    # -- inverse kinematics ----------------------------------------------------------------------------------

    def reach(
        self, pose: Pose, base: Array, near: Array, *, torsos: Sequence[float] | None = None,
        most: int = 8,
    ) -> Path:
        """Configurations that reach a pose, best first: near ``near``, away from limits, of different branches."""
        heights = self.body.lifts if torsos is None else np.asarray(torsos, float)
        pose.expressed_in(self.robot.frame)
        found = self.kinematics.solutions(pose.position, pose.rotation, base, lifts=heights)
        if not len(found):
            return []
        change = np.abs(found - near)
        spare = np.minimum(found - self.body.lower, self.body.upper - found)[:, 4:].min(axis=1)
        cost = change[:, 4:].max(axis=1) + 0.3 * change[:, 4:].mean(axis=1) + change[:, 3]
        cost += np.maximum(0.0, 2.0 * (0.15 - spare) / 0.15)
        kept: Path = []
        while len(kept) < most and np.isfinite(cost).any():
            best = found[int(np.argmin(cost))]
            kept.append(best)
            cost[np.abs(found - best)[:, 4:].max(axis=1) <= 0.35] = np.inf
        return kept


class _Tree:
    """Nodes of a search tree with their parents."""

    def __init__(self, root: Array) -> None:
        self.nodes: list[Array] = [root]
        self._parents = [-1]

    def add(self, node: Array, parent: int) -> None:
        self.nodes.append(node)
        self._parents.append(parent)

    def branch(self) -> Path:
        """From the newest node back to the root."""
        path, k = [], len(self.nodes) - 1
        while k >= 0:
            path.append(self.nodes[k])
            k = self._parents[k]
        return path
