"""The surface on which fixtures build themselves. The only module of the kitchen's furniture that knows MjSpec."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, sin
from typing import Any, NamedTuple

import mujoco
import numpy as np

from remac_env.kitchen.frame import Frame
from remac_env.kitchen.meshes import Mesh, add_mesh, merge
from remac_env.kitchen.pieces import bar, board

Vector = Sequence[float]
Fronts = tuple[str, str]
"""How doors and drawers are made: a name of style.PANELS, and one of style.PULLS."""

COLLIDER_GROUP, DRAWN_GROUP = 3, 1
FINE_GROUP, COARSE_GROUP, HIDDEN_GROUP = 2, 4, 5
"""Boards and bars are there twice: fine for large pictures, coarse for small ones. MuJoCo's viewer hides group 4."""
DRAWN_GROUPS = (DRAWN_GROUP, FINE_GROUP, COARSE_GROUP)
SWITCHED = "/glow_"
"""Between a switch's name and a number, in the names of geoms that are seen only while it is on."""
# Who touches whom (contype/conaffinity): furniture 1/0, door panels 1/1, objects 2/3 and their feet 0/1, robots 4/7.
FURNITURE_CONTYPE, FURNITURE_CONAFFINITY = 1, 0
_FURNITURE_FRICTION, _EDGE = (0.8, 0.005, 0.0001), 0.004  # sliding, torsional, rolling; m


class _Coat(NamedTuple):
    """What the shapes of one body must have in common to be drawn as one mesh."""

    body: str
    material: str
    switch: str | None
    opacity: float | None


class Canvas:
    """Takes bodies, colliders and drawn shapes; `finish` must be called last.

    Lengths are metres, angles radians, z up; the frame is the world's until `stand` gives another. Drawn shapes weigh
    nothing and touch nothing, so bodies, joints and motion are the same with and without them. With `visual` off every
    drawn shape is left out. Boxes and bars of one body and material become one mesh: pictures cost by the number of
    geoms.
    """

    def __init__(self, spec: mujoco.MjSpec, *, visual: bool, fronts: Fronts = ("shaker", "bar")) -> None:
        """Build into `spec`; with `visual`, its materials must already be there, named by role."""
        self.visual, self.fronts = visual, fronts
        self._spec = spec
        self._ground = spec.worldbody
        self._bodies: dict[str, Any] = {}
        self._coats: dict[_Coat, list[tuple[Mesh, Mesh]]] = {}
        self._shared: set[str] = set()
        self._switched: dict[str, int] = {}

    def stand(self, name: str, frame: Frame) -> None:
        """Add a body that stands still; bodies and lights from here on are given in its frame."""
        turn = [cos(0.5 * frame.heading), 0.0, 0.0, sin(0.5 * frame.heading)]
        self._ground = self._spec.worldbody.add_body(name=name, pos=[frame.x, frame.y, 0.0], quat=turn)

    def body(self, name: str, position: Vector = (0, 0, 0), *, balanced: bool = False, swings: bool = False) -> Part:
        """Add a body to the frame in force. balanced: its weight turns no joint; swings: it meets other furniture."""
        self._bodies[name] = self._ground.add_body(name=name, pos=list(position), gravcomp=float(balanced))
        return Part(self, name, self._bodies[name], meets=FURNITURE_CONTYPE if swings else FURNITURE_CONAFFINITY)

    def part(self, name: str) -> Part:
        """A body that was added before, to be added to."""
        return Part(self, name, self._bodies[name], meets=FURNITURE_CONAFFINITY)

    def light(self, name: str, position: Vector, direction: Vector, color: Vector, *, cutoff: float) -> None:
        """Add a spot light without shadow, cutoff in degrees; nothing without visual geometry."""
        if self.visual:
            self._ground.add_light(
                name=name,
                type=mujoco.mjtLightType.mjLIGHT_SPOT,
                pos=list(position),
                dir=list(direction),
                cutoff=cutoff,
                exponent=2,
                attenuation=[0.7, 0.4, 0.5],
                diffuse=list(color),
                specular=list(color),
                ambient=[0, 0, 0],
                castshadow=False,
            )

    def paint(
        self, body: str, fine: Mesh, coarse: Mesh, material: str, switch: str | None, opacity: float | None
    ) -> None:
        """Keep a shape, in the frame of its body, until `finish`: for large and for small pictures."""
        self._coats.setdefault(_Coat(body, material, switch, opacity), []).append((fine, coarse))

    def finish(self) -> None:
        """Turn all that was painted into geoms."""
        for number, (coat, pairs) in enumerate(self._coats.items()):
            for group, meshes in zip((FINE_GROUP, COARSE_GROUP), zip(*pairs, strict=True), strict=True):
                name = f"coat_{number}/{group}"
                add_mesh(self._spec, name, merge(*meshes))
                self.draw(coat.body, coat.material, coat.switch, coat.opacity, meshname=name, group=group)
        self._coats.clear()

    def share(self, name: str, mesh: Mesh) -> None:
        """Add a mesh on the first use of its name."""
        if name not in self._shared:
            add_mesh(self._spec, name, mesh)
            self._shared.add(name)

    def draw(
        self, body: str, material: str, switch: str | None = None, opacity: float | None = None, **shape: Any
    ) -> None:
        """Add a drawn geom, a mesh unless `shape` says otherwise. Those of a switch start out invisible."""
        if switch is not None:
            count = self._switched[switch] = self._switched.get(switch, -1) + 1
            shape["name"] = f"{switch}{SWITCHED}{count}"
            opacity = 0.0
        if opacity is not None:
            shape["rgba"] = [*(float(value) for value in self._spec.material(material).rgba[:3]), opacity]
        shape = {"type": mujoco.mjtGeom.mjGEOM_MESH, "group": DRAWN_GROUP, **shape}
        self._bodies[body].add_geom(contype=0, conaffinity=0, mass=0.0, material=material, **shape)


class Part:
    """One body of a fixture. Positions are in its own frame, whose axes are those of the frame it stands in."""

    def __init__(self, canvas: Canvas, name: str, body: Any, *, meets: int) -> None:
        """Wrap an MjSpec body; meets: the conaffinity of its colliders."""
        self._canvas = canvas
        self._meets = meets
        self._name = name
        self._body = body

    @property
    def visual(self) -> bool:
        """Whether drawn shapes are kept."""
        return self._canvas.visual

    @property
    def fronts(self) -> Fronts:
        """How doors and drawers are made."""
        return self._canvas.fronts

    # Colliders. Options: mass (kg), friction, name.

    def collision_box(self, low: Vector, high: Vector, **options: Any) -> None:
        """Add a box collider between two corners."""
        middle, half = (np.asarray(low) + high) / 2, (np.asarray(high) - low) / 2
        self._collision(type=mujoco.mjtGeom.mjGEOM_BOX, pos=middle, size=half, **options)

    def collision_cylinder(self, start: Vector, end: Vector, radius: float, **options: Any) -> None:
        """Add a cylinder collider between the middles of its two ends."""
        self._collision(type=mujoco.mjtGeom.mjGEOM_CYLINDER, fromto=[*start, *end], size=[radius, 0, 0], **options)

    def collision_capsule(self, start: Vector, end: Vector, radius: float, **options: Any) -> None:
        """Add a capsule collider between the centres of its round ends."""
        self._collision(type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=[*start, *end], size=[radius, 0, 0], **options)

    def collision_floor(self, **options: Any) -> None:
        """Add an endless level plane through the body's origin."""
        self._body.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.1], group=COLLIDER_GROUP, **options)

    # Joints and sites

    def hinge(
        self,
        name: str,
        *,
        axis: Vector,
        limits: tuple[float, float],
        damping: float,
        friction: float,
        armature: float,
    ) -> None:
        """Add a hinge at the body's origin: N m s/rad, N m, kg m2."""
        self._joint(mujoco.mjtJoint.mjJNT_HINGE, name, axis, limits, damping, friction, armature)

    def slide(
        self,
        name: str,
        *,
        axis: Vector,
        limits: tuple[float, float],
        damping: float,
        armature: float,
        friction: float = 0.0,
        stiffness: float = 0.0,
    ) -> None:
        """Add a sliding joint, perhaps with a spring that rests at 0: N s/m, kg, N, N/m."""
        joint = self._joint(mujoco.mjtJoint.mjJNT_SLIDE, name, axis, limits, damping, friction, armature)
        joint.stiffness = [stiffness, 0, 0]

    def site(self, name: str, position: Vector) -> None:
        """Mark a point."""
        self._body.add_site(name=name, pos=list(position), size=[0.01] * 3, group=4)

    # Drawing. switch: seen only while it is on; opacity, 0..1, makes a plain material see-through.

    def visual_box(
        self,
        low: Vector,
        high: Vector,
        material: str,
        *,
        radius: float = _EDGE,
        segments: int = 1,
        switch: str | None = None,
        opacity: float | None = None,
        world_grain: bool = False,
    ) -> None:
        """Draw a box with bevelled edges; world_grain lets neighbouring slabs share one pattern."""
        if self.visual:
            fine, coarse = (board(_point(low), _point(high), edge, segments, world_grain) for edge in (radius, 0.0))
            self._canvas.paint(self._name, fine, coarse, material, switch, opacity)

    def visual_cylinder(
        self, start: Vector, end: Vector, radius: float, material: str, *, switch: str | None = None
    ) -> None:
        """Draw a cylinder between the middles of its two ends."""
        self._rod(start, end, radius, material, switch, round_ends=False)

    def visual_capsule(
        self, start: Vector, end: Vector, radius: float, material: str, *, switch: str | None = None
    ) -> None:
        """Draw a capsule between the centres of its round ends."""
        self._rod(start, end, radius, material, switch, round_ends=True)

    def visual_mesh(
        self,
        name: str,
        mesh: Mesh,
        position: Vector,
        material: str,
        *,
        rotation: Vector = (1.0, 0.0, 0.0, 0.0),
        switch: str | None = None,
    ) -> None:
        """Draw a mesh, shared by name, at a position, turned by a quaternion (w, x, y, z)."""
        if self.visual:
            self._canvas.share(name, mesh)
            self._canvas.draw(self._name, material, switch, pos=list(position), quat=list(rotation), meshname=name)

    def visual_ball(self, center: Vector, half: Vector, material: str) -> None:
        """Draw an ellipsoid with three half axes."""
        if self.visual:
            self._canvas.draw(
                self._name, material, type=mujoco.mjtGeom.mjGEOM_ELLIPSOID, pos=list(center), size=list(half)
            )

    def visual_sheet(self, center: Vector, half: tuple[float, float], facing: Vector, material: str) -> None:
        """Draw a sheet seen only from where `facing` points; half: (sideways, upwards), or (x, y) if level."""
        if self.visual:
            self._canvas.draw(
                self._name,
                material,
                type=mujoco.mjtGeom.mjGEOM_PLANE,
                pos=list(center),
                size=[*half, 0.1],
                quat=_sheet_turn(facing),
            )

    def _rod(
        self, start: Vector, end: Vector, radius: float, material: str, switch: str | None, *, round_ends: bool
    ) -> None:
        if self.visual:
            fine, coarse = (bar(_point(start), _point(end), radius, ends) for ends in (round_ends, False))
            self._canvas.paint(self._name, fine, coarse, material, switch, None)

    def _collision(self, **options: Any) -> None:
        options.setdefault("friction", _FURNITURE_FRICTION)
        self._body.add_geom(contype=FURNITURE_CONTYPE, conaffinity=self._meets, group=COLLIDER_GROUP, **options)

    def _joint(
        self, kind: Any, name: str, axis: Vector, limits: tuple[float, float], damping: float, friction: float,
        armature: float,
    ) -> Any:  # fmt: skip
        return self._body.add_joint(
            type=kind,
            name=name,
            axis=list(axis),
            range=list(limits),
            limited=True,
            damping=[damping, 0, 0],
            frictionloss=friction,
            armature=armature,
        )


def _sheet_turn(facing: Vector) -> list[float]:
    """Return the quaternion that turns a plane's normal to `facing`, keeping its second axis up where it can."""
    normal = np.asarray(facing, float) / np.linalg.norm(facing)
    up = np.array([0.0, 0.0, 1.0]) if abs(normal[2]) < 0.9 else np.array([0.0, np.sign(normal[2]), 0.0])
    turn = np.empty(4)
    mujoco.mju_mat2Quat(turn, np.stack([np.cross(up, normal), up, normal], axis=1).ravel())
    return [float(value) for value in turn]


def _point(vector: Vector) -> tuple[float, float, float]:
    return vector[0], vector[1], vector[2]
