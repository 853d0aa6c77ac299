"""How near robots come to one another, with what they hold: for planning traffic and for counting near misses."""

from __future__ import annotations

import copy
import math
from collections.abc import Collection, Iterable, Mapping
from itertools import combinations

import mujoco
import numpy as np

from remac_env.backends.physics.simulation import Simulation
from remac_env.robots.footprints import Footprint, radius
from remac_env.robots.rotation import Array

NEAR_MISS = 0.05  # m
_NEAR = NEAR_MISS + 0.01  # m up to which distances are told apart
_FAR = 2.4  # m between two bases from which on arms cannot meet
_BASE = 16  # by how many bits those of bases are above those of the rest of their robots


class Separation:
    """Distances between robots, measured on a copy in which nothing else collides."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._model = copy.copy(simulation.model)
        self._data = mujoco.MjData(self._model)
        self._held: dict[str, str] = {}
        names = [self._model.body(b).name for b in range(self._model.nbody)]
        self._bodies = {
            robot: [b for b, name in enumerate(names) if name.startswith(robot + "/")] for robot in simulation.robots
        }
        self._model.opt.enableflags = 0
        self._model.geom_margin[:] = _NEAR
        self._set_masks()

    def holding(self, held: Mapping[str, str]) -> None:
        """Let these objects (robot -> body) count as parts of the robots that hold them."""
        if held != self._held:
            self._held = dict(held)
            self._set_masks()

    def of_world(self) -> float:
        """Least distance (m) between robots now; at most 0.06 is told apart, larger ones are infinite."""
        qpos = self._simulation.data.qpos
        places = [qpos[robot.qpos[:2]] for robot in self._simulation.robots.values()]
        if all(math.dist(one, other) > _FAR for one, other in combinations(places, 2)):
            return math.inf
        self._data.qpos[:] = qpos
        return self._measure()

    def of_configurations(
        self, configurations: Mapping[str, Array], attached: Mapping[str, tuple[int, Array]],
        without: Collection[str] = (),
    ) -> float:
        """Least distance (m) with robots in these configurations.

        ``attached``: robot -> (qpos address, pose (7,)) of what it holds there; all else is as in the world.
        ``without``: robots that count for nothing.
        """
        for name, q in configurations.items():
            self._data.qpos[self._simulation.robots[name].qpos] = q
        for address, pose in attached.values():
            self._data.qpos[address : address + 7] = pose
        return self._measure(frozenset(without))

    @property
    def robots(self) -> tuple[str, ...]:
        """All robots."""
        return tuple(self._bodies)

    @property
    def held(self) -> Mapping[str, str]:
        """Robot -> body of what it holds, as last told."""
        return self._held

    @property
    def places(self) -> dict[str, Array]:
        """Robot -> pose of its base (3,) now."""
        return {name: robot.standing for name, robot in self._simulation.robots.items()}

    def circles(self, robots: Collection[str]) -> Array:
        """Circles (n, 3) around the parts of some robots, seen from above: x, y and radius, as last refreshed."""
        mujoco.mj_kinematics(self._model, self._data)
        bodies = [b for name in robots for b in (*self._bodies[name], *self._held_bodies(name))]
        collision = np.isin(self._model.geom_bodyid, bodies) & (self._model.geom_group == 3)
        return np.column_stack([self._data.geom_xpos[collision, :2], self._model.geom_rbound[collision]])

    def _held_bodies(self, robot: str) -> list[int]:
        return [self._model.body(self._held[robot]).id] if robot in self._held else []

    def refresh(self) -> None:
        """Copy the world's configuration, before a series of :meth:`of_configurations`."""
        self._data.qpos[:] = self._simulation.data.qpos

    def _measure(self, without: frozenset[str] = frozenset()) -> float:
        """Least distance (m) as posed; ``without``: robots that count for nothing."""
        mujoco.mj_kinematics(self._model, self._data)
        bases = self._between_bases(without)
        try:
            mujoco.mj_collision(self._model, self._data)
        except mujoco.FatalError:
            # Deeply overlapping boxes can yield more contacts than MuJoCo allows for.
            qpos = self._data.qpos.copy()
            self._data = mujoco.MjData(self._model)
            self._data.qpos[:] = qpos
            return 0.0
        counted: Iterable[int] = range(self._data.ncon)
        if without:
            bits = sum((1 | 1 << _BASE) << number for number, name in enumerate(self._bodies) if name in without)
            robots = self._model.geom_contype[self._data.contact.geom]
            counted = [k for k in counted if not (robots[k] & bits).any()]
        return min([bases, *map(self._distance, counted)])

    def _between_bases(self, without: frozenset[str]) -> float:
        """Least distance (m) between bases; larger ones than are told apart are infinite.

        Of two upright boxes at one height MuJoCo's contacts with margins are not to be relied on: some are missing.
        """
        qpos, robots = self._data.qpos, self._simulation.robots
        places = [qpos[robots[name].qpos[:3]] for name in self._bodies if name not in without]
        gaps = (bases_apart(one, other, self._simulation.body.footprint) for one, other in combinations(places, 2))
        return min((gap for gap in gaps if gap <= _NEAR), default=math.inf)

    def _distance(self, number: int) -> float:
        """Distance (m) of one contact.

        Between boxes that do not touch, but are nearer than their margins, MuJoCo's contacts sometimes claim an
        overlap of most of a box; its general distance says otherwise.
        """
        contact = self._data.contact
        if contact.dist[number] < 0.0:
            one, other = (int(geom) for geom in contact.geom[number])
            return float(mujoco.mj_geomDistance(self._model, self._data, one, other, _NEAR, None))
        return float(contact.dist[number])

    def _set_masks(self) -> None:
        model = self._model
        for masks in (model.geom_contype, model.geom_conaffinity, model.body_contype, model.body_conaffinity):
            masks[:] = 0
        every = (1 << len(self._bodies)) - 1
        for number, (robot, bodies) in enumerate(self._bodies.items()):
            others = every & ~(1 << number)
            for body in [*bodies, *self._held_bodies(robot)]:
                # A skirt is right under the rest of its base, so it is nowhere nearer to others.
                skirt = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, f"{robot}/{self._simulation.body.skirt}")
                geoms = [
                    g for g in range(model.ngeom)
                    if model.geom_bodyid[g] == body and model.geom_group[g] == 3 and g != skirt
                ]  # fmt: skip
                # Bases meet all but other bases.
                base = model.body(body).name == f"{robot}/base"
                model.geom_contype[geoms] = model.body_contype[body] = 1 << number + _BASE * base
                meets = others if base else others | others << _BASE
                model.geom_conaffinity[geoms] = model.body_conaffinity[body] = meets


def bases_apart(one: Array, other: Array, footprint: Footprint) -> float:
    """Least distance (m) between two bases with this footprint, seen from above; 0 where they overlap.

    ``one``, ``other``: poses (3,), x and y in m and the heading in rad.
    """
    (x0, y0), (x1, y1) = footprint
    if math.hypot(one[0] - other[0], one[1] - other[1]) > 2.0 * radius(footprint) + _NEAR:
        return math.inf
    low, high, corners = np.array([x0, y0]), np.array([x1, y1]), np.array([[x0, y0], [x0, y1], [x1, y0], [x1, y1]])
    least, overlap = math.inf, True
    for pose, seen_by in ((one, other), (other, one)):
        turn, place = pose[2] - seen_by[2], _turned(pose[:2] - seen_by[:2], -seen_by[2])
        points = _turned(corners, turn) + place
        outside = np.maximum(np.maximum(low - points, points - high), 0.0)
        least = min(least, float(np.hypot(*outside.T).min()))
        overlap &= bool((points.max(axis=0) >= low).all() and (points.min(axis=0) <= high).all())
    return 0.0 if overlap else least


def _turned(points: Array, angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    return points @ np.array([[c, s], [-s, c]])
