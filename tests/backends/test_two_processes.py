"""The same seed is the same episode, bit for bit, in another process with another hash seed and other resets before."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

PLAY = """
import hashlib, sys
import remac_env
from remac_env.oracle import solve

env = remac_env.parallel_env("DefrostInBowl", robots=2)
for other in map(int, sys.argv[1].split(",")):
    env.reset(seed=other)
env.reset(seed=41)
digest = hashlib.sha256()
for joint in solve(env.start.scene, env.world, env.goal).rounds[:2]:
    env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
    digest.update(env._backend.positions().tobytes())
print(env.start.digest, digest.hexdigest())
"""


def play(hash_seed: str, resets_before: str) -> str:
    """The digests of one episode played in a fresh process."""
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(
        [sys.executable, "-c", PLAY, resets_before], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_states_are_bit_identical_in_two_processes() -> None:
    first, second = play("1", "41"), play("2", "7")
    assert first and first == second


def test_a_wrong_gl_variable_gets_a_message_with_the_fix() -> None:
    code = "import remac_env; remac_env.parallel_env('HeatOnStove').reset(seed=0)"
    environment = {**os.environ, "MUJOCO_GL": "nonsense", "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "MUJOCO_GL='nonsense'" in done.stderr and "unset MUJOCO_GL" in done.stderr
