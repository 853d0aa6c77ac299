"""The same seed is the same episode, bit for bit, in another process with another hash seed and other resets before."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import remac_env
from remac_env.oracle import solve


def played(*resets_before: int) -> str:
    """The digests of one episode."""
    env = remac_env.parallel_env("DefrostInBowl", robots=2)
    for other in resets_before:
        env.reset(seed=other)
    env.reset(seed=41)
    digest = hashlib.sha256()
    for joint in solve(env.start.scene, env.world, env.goal).rounds[:2]:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
        digest.update(env._backend.positions().tobytes())
    return f"{env.start.digest} {digest.hexdigest()}"


def test_states_are_bit_identical_in_two_processes() -> None:
    hash_seed = "1" if os.environ.get("PYTHONHASHSEED") != "1" else "2"  # not ours
    folders = os.pathsep.join(map(str, (Path(__file__).parents[2], Path(__file__).parent)))
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": folders}
    code = "import test_two_processes; print(test_two_processes.played(7))"
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == played(41)


def test_a_wrong_gl_variable_gets_a_message_with_the_fix() -> None:
    code = "import remac_env; remac_env.parallel_env('HeatOnStove').reset(seed=0)"
    environment = {**os.environ, "MUJOCO_GL": "nonsense", "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "MUJOCO_GL='nonsense'" in done.stderr and "unset MUJOCO_GL" in done.stderr
