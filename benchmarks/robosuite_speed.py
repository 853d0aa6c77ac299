"""Control steps a second in robosuite's environments: part of `python benchmarks/speed.py --only robosuite`."""

from __future__ import annotations

from time import process_time

import numpy as np

WARM, COUNT = 50, 100
"""Steps before it is timed, as the first ones compile robosuite's controllers with numba, and steps that are timed."""


def rate(name: str, robot: str, count: int, step: float = 0.002) -> float | None:
    """Control steps of 0.05 s a second of CPU time, None where robosuite is not installed.

    `step`: of the simulation, s; robosuite's own is 2 ms.
    """
    try:
        import robosuite
        from robosuite import macros

        import remac_env.integrations.robosuite  # noqa: F401 - registers the kitchens
    except ImportError:
        return None
    usual, macros.SIMULATION_TIMESTEP = macros.SIMULATION_TIMESTEP, step
    try:
        env = robosuite.make(
            name, robots=[robot] * count, has_renderer=False, has_offscreen_renderer=False, use_camera_obs=False, seed=0
        )
        env.reset()
        rest = np.zeros(env.action_dim)
        for _ in range(WARM):
            env.step(rest)
        began = process_time()
        for _ in range(COUNT):
            env.step(rest)
        return COUNT / (process_time() - began)
    finally:
        macros.SIMULATION_TIMESTEP = usual
