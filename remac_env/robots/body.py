"""What a body is: all that kitchens, skills and pictures know of the kind of robot that stands in them.

A configuration ``q`` is a vector (n,) of a body's joints in their order: base x, base y, base yaw, the lift of its arm,
and its arm's joints. Lengths in m, angles in rad, forces in N, torques in N m; speeds a second.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import mujoco

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Fingertip:
    """A fingertip's measures, m: how far it reaches beyond the grip site, half its width, and its thickness.

    The thickness is along its travel, the width across that and across the hand's approach.
    """

    beyond: float
    half_width: float
    thickness: float


class Tracked(Protocol):
    """A step of tracking: the configuration, and the errors of position (m) and rotation (rad) that were left."""

    @property
    def q(self) -> Array:
        """The configuration after it."""

    @property
    def position_error(self) -> float:
        """Metres."""

    @property
    def rotation_error(self) -> float:
        """Radians."""


class Kinematics(Protocol):
    """Where an arm's hand is, and how it gets somewhere. Holds scratch memory: one per thread."""

    @property
    def body(self) -> Body:
        """Whose arm it is."""

    def forward(self, q: Array) -> tuple[Array, Array]:
        """Position (3,) and rotation (3, 3) of the grip in configuration ``q``, in the frame of ``q``."""

    def track(
        self, q: Array, position: Array, rotation: Array, *, weights: Array = ..., iterations: int = ...,
        damping: float = ..., largest: Array,
    ) -> Tracked:
        """Move ``q`` towards a pose of the grip, each joint by at most ``largest`` (n,), as ``weights`` (n,) favour."""

    def solutions(self, position: Array, rotation: Array, base: Array, *, lifts: Array) -> Array:
        """Configurations (k, n) within limits that reach a pose from a base pose (3,), at these heights of the lift."""


class Body(Hashable, Protocol):
    """A kind of robot. Names of joints, bodies and sites in a model are ``<robot>/<name>``.

    Attributes:
        joints: names, in the order of configurations. fingers: those of the hand, each a joint and a body, which move
            alike from 0 to ``finger_travel``. hands: a name for each hand; arms and hands are the same in number.
        skirt: the name of the geom under the base that pushes objects away.
        lower, upper: (n,) between which configurations are planned; lowest, highest: (n,) between which set-points are.
        speed, top_speed: (n,) of plans, and that the maker allows. acceleration: of the base in drives.
        torques: the largest that the arm's joints give. finger_stiffness: N/m; grip_friction: of what touches objects.
        fingertip: its measures; palm: how far (m) the palm is from the grip site.
        footprint: low and high corner (x, y) of the base around its axis, as it heads along x.
        folded: postures of the arm's joints: ``tuck`` of a robot at rest; via: those that ways lead by.
        lift_tucked: of the lift at rest; lifts: heights of it that are tried.
        arm_weights, door_weights: (n,) what counts in tracking: the arm, or the base too, a little.
        fingerprint: a name for what learnt skills and certificates depend on; it changes whenever the model does.
    """

    joints: tuple[str, ...]
    fingers: tuple[str, ...]
    hands: tuple[str, ...]
    skirt: str
    lower: Array
    upper: Array
    lowest: Array
    highest: Array
    speed: Array
    top_speed: Array
    acceleration: float
    torques: tuple[float, ...]
    finger_travel: float
    finger_stiffness: float
    grip_friction: float
    fingertip: Fingertip
    palm: float
    footprint: tuple[tuple[float, float], tuple[float, float]]
    folded: Array
    via: tuple[Array, ...]
    lift_tucked: float
    lifts: Array
    arm_weights: Array
    door_weights: Array

    @property
    def name(self) -> str:
        """What `parallel_env(body=...)` calls it."""

    @property
    def fingerprint(self) -> str:
        """A name for what skills that were learnt with it, and its certificates, depend on."""

    def tuck(self, x: float, y: float, yaw: float) -> Array:
        """The configuration (n,) with the arm folded and its axis at ``x``, ``y``, heading ``yaw``."""

    def add_to(
        self, spec: mujoco.MjSpec, name: str, *, visual: bool = False,
        accent: tuple[float, float, float] = (0.1, 0.4, 0.8),
    ) -> None:
        """Add a robot of this kind at the world's origin; joints and their order do not depend on ``visual``."""

    def kinematics(self, arm: str = "") -> Kinematics:
        """Of an arm, by the name of its hand; of the only one where "" is given."""

