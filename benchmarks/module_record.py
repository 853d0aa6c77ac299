"""What a robot did in one step of a trial: how its hand came to what it touched, and the floor its base took."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.robots.body import Body

_STRAIGHT = 0.006  # m by which a straight approach may stray


@dataclass(frozen=True)
class Touch:
    """How the hand came to what it touched: stance (x, y in m, yaw in rad), reach (m), pitch (rad), approach (m)."""

    stance: tuple[float, float, float]
    reach: float
    pitch: float
    approach: float


class Recorder:
    """Notes at every control step where the robot stands, what its fingers touch, and where its hand is."""

    def __init__(self, backend: PhysicsBackend, robot: str, body: Body, targets: Sequence[str]) -> None:
        self.model, self.data, self.robot = backend.model, backend.data, robot
        self._base = body.joints[:3]
        self._fingers = [self.model.body(f"{robot}/{part}").id for part in body.fingers]
        self._targets = {self.model.body(name).id: name for name in targets}
        base, box = geoms(self.model, f"{robot}/base"), mujoco.mjtGeom.mjGEOM_BOX
        self._boxes = [geom for geom in base if self.model.geom_type[geom] == box]
        self.grips: list[np.ndarray] = []
        self.ways: list[np.ndarray] = []
        self.stands: list[np.ndarray] = []
        self.touched: dict[str, list[int]] = defaultdict(list)
        self.low, self.high = np.full(2, np.inf), np.full(2, -np.inf)

    def __call__(self) -> None:
        """One control step has been simulated."""
        data, site = self.data, self.data.site(f"{self.robot}/grip")
        self.grips.append(site.xpos.copy())
        self.ways.append(site.xmat.reshape(3, 3)[:, 2].copy())
        self.stands.append(np.array([data.joint(f"{self.robot}/{part}").qpos[0] for part in self._base]))
        for box in self._boxes:
            reach = np.abs(data.geom_xmat[box].reshape(3, 3)) @ self.model.geom_size[box]
            self.low = np.minimum(self.low, (data.geom_xpos[box] - reach)[:2])
            self.high = np.maximum(self.high, (data.geom_xpos[box] + reach)[:2])
        for pair in self.model.geom_bodyid[data.contact.geom[: data.ncon]]:
            for one, other in (pair, pair[::-1]):
                if int(one) in self._fingers and int(other) in self._targets:
                    self.touched[self._targets[int(other)]].append(len(self.grips) - 1)

    def touches(self, middle: float, *, last: bool) -> Iterator[Touch]:
        """What was so at the first touch of each target, or the last; stances from `middle`, x of the variant's."""
        for ticks in self.touched.values():
            tick = ticks[-1] if last else ticks[0]
            x, y, yaw = (float(value) for value in self.stands[tick])
            reach = float(np.hypot(*(self.grips[tick][:2] - (x, y))))
            pitch = float(np.arcsin(np.clip(self.ways[tick][2], -1.0, 1.0)))
            yield Touch((x - middle, y, yaw), reach, pitch, self._approach(tick))

    def _approach(self, tick: int) -> float:
        """How far, m, the hand had come straight there."""
        at, farthest = self.grips[tick], 0.0
        for earlier in range(tick - 1, -1, -1):
            back = np.array(self.grips[earlier:tick]) - at
            length = float(np.linalg.norm(back[0]))
            if length < farthest - _STRAIGHT:
                break
            if length > _STRAIGHT:
                along = back @ back[0] / length
                if np.linalg.norm(back - np.outer(along, back[0] / length), axis=1).max() > _STRAIGHT:
                    break
            farthest = max(farthest, length)
        return farthest


def geoms(model: mujoco.MjModel, body: str) -> list[int]:
    """Ids of the geoms of a body."""
    entry = model.body(body)
    return list(range(int(entry.geomadr[0]), int(entry.geomadr[0]) + int(entry.geomnum[0])))
