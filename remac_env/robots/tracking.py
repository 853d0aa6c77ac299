"""Where the hand of a body's model is and how it is led to a pose: all of `Kinematics` but its closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np

from remac_env.errors import OptionError
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array, rotation_vector

_ROTATION_WEIGHT = 0.5  # m/rad: what a turn counts beside a shift
_ROW_WEIGHTS = np.array([[1.0]] * 3 + [[_ROTATION_WEIGHT]] * 3)


@dataclass(frozen=True)
class Tracked:
    """Result of a tracking step: configuration, remaining position (m) and rotation (rad) errors before it."""

    q: Array
    position_error: float
    rotation_error: float


class ModelKinematics:
    """Forward kinematics and damped least squares on a model of one robot. Holds scratch memory: one per thread.

    What is left to a body of one's own is ``solutions``, see `remac_env.robots.body.Kinematics`.
    """

    def __init__(self, body: Body) -> None:
        self.body = body
        self._model = bare_model(body)
        self._data = mujoco.MjData(self._model)
        self._site = self._model.site("robot/grip").id
        count = len(body.joints)
        self._jacobian = np.zeros((6, self._model.nv))
        self._linear, self._angular, self._columns = self._jacobian[:3], self._jacobian[3:], self._jacobian[:, :count]
        self._qpos = self._data.qpos[:count]
        self._position = self._data.site_xpos[self._site]
        self._rotation = self._data.site_xmat[self._site].reshape(3, 3)

    def forward(self, q: Array) -> tuple[Array, Array]:
        """Grip position (3,) and rotation (3, 3) at ``q``."""
        self._qpos[:] = q
        mujoco.mj_kinematics(self._model, self._data)
        return self._position.copy(), self._rotation.copy()

    def jacobian(self, q: Array) -> Array:
        """(6, n): linear then angular velocity of the grip by joint velocity, in the world."""
        self._qpos[:] = q
        mujoco.mj_kinematics(self._model, self._data)
        self._refresh_jacobian()
        return self._columns.copy()

    def _refresh_jacobian(self) -> None:
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_jacSite(self._model, self._data, self._linear, self._angular, self._site)

    def track(
        self, q: Array, position: Array, rotation: Array, *, weights: Array | None = None, iterations: int = 4,
        damping: float = 0.02, largest: Array,
    ) -> Tracked:
        """Move ``q`` towards a pose by damped least squares, each joint by at most ``largest`` (n,).

        ``weights``: (n,) what joints count, the body's ``arm_weights`` where None.
        """
        weights = self.body.arm_weights if weights is None else weights
        lower, upper = self.body.lower, self.body.upper
        start = q
        error, step = np.empty(6), np.empty(6)
        for iteration in range(iterations + 1):
            self._qpos[:] = q
            mujoco.mj_kinematics(self._model, self._data)
            turn = rotation_vector(rotation @ self._rotation.T)
            error[:3] = position - self._position
            error[3:] = turn
            ep, er = math.sqrt(float(error[:3] @ error[:3])), math.sqrt(float(turn @ turn))
            if iteration == iterations or (ep < 3e-4 and er < 2e-3):
                break
            error[3:] *= _ROTATION_WEIGHT
            size = math.hypot(ep, _ROTATION_WEIGHT * er)
            if size > 0.3:
                error *= 0.3 / size
            self._refresh_jacobian()
            scaled = self._columns * _ROW_WEIGHTS
            weighted = scaled * weights
            normal = weighted @ scaled.T
            normal.flat[::7] += damping * damping
            # MuJoCo's Cholesky: a third of the time of numpy's general solver on six rows.
            mujoco.mju_cholFactor(normal, 0.0)
            mujoco.mju_cholSolve(step, normal, error)
            q = np.minimum(upper, np.maximum(lower, q + step @ weighted))
        change = np.minimum(largest, np.maximum(-largest, q - start))
        return Tracked(start + change, ep, er)


@lru_cache(maxsize=8)
def bare_model(body: Body) -> mujoco.MjModel:
    """A model that holds one robot called ``robot`` and nothing else, for kinematics. Shared: do not change it.

    Raises:
        OptionError: where the model's joints are not those of the body, in their order, and then its fingers.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    body.add_to(spec, "robot")
    for geom in list(spec.geoms):
        geom.contype = geom.conaffinity = 0
    model = spec.compile()
    found = [model.joint(number).name.removeprefix("robot/") for number in range(model.njnt)]
    wanted = [*body.joints, *body.fingers]
    if found != wanted or model.nq != len(wanted):
        raise OptionError(f"the model of body {body.name!r} has the joints {found}; valid: {wanted}, in this order")
    return model
