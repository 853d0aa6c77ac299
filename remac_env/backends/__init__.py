"""The two backends of one table: symbolic (pure Python) and physics (MuJoCo)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from remac_env.backends.base import Backend
from remac_env.backends.symbolic import SymbolicBackend
from remac_env.simulator import load_mujoco

if TYPE_CHECKING:
    from remac_env.kitchen.worlds import TaskWorlds
    from remac_env.options import Options


def make_backend(options: Options, worlds: TaskWorlds) -> Backend:
    """The backend that the options name; physics loads MuJoCo."""
    if options.backend == "symbolic":
        return SymbolicBackend(failure_rate=options.failure_rate)
    load_mujoco()
    from remac_env.backends.physics.backend import PhysicsBackend

    return PhysicsBackend(worlds)
