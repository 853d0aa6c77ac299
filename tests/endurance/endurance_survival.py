"""Episodes as strings that can be compared between processes and threads, and how much memory is in use."""

from __future__ import annotations

import gc
import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import remac_env
from remac_env.oracle import solve
from remac_env.seeding import generator

LOOK = {"style": "modern_1", "layout": "one_wall_small"}
"""One cell for all, so that no test reads and compiles kitchens most of its time."""


def make(backend: str, **options: Any) -> Any:
    """A two-robot environment of one cell."""
    return remac_env.parallel_env("OpenMicrowavePnP", backend=backend, **(LOOK | options))


def begin(env: Any, seed: int) -> str:
    """Reset; the start as one string."""
    env.reset(seed=seed)
    return str(env.start.digest)


def walk(env: Any, *, rounds: int, salt: int) -> list[str]:
    """Go on with legal tokens drawn from a seed; a string a round."""
    chance, told = generator(salt, "survival"), []
    commands = sorted(env._episode.terms.commands.values())
    for _ in range(rounds):
        if not env.agents:
            break
        joint = {name: int(chance.choice([c for c in commands if c != 1])) for name in env.agents}
        _, rewards, _, _, infos = env.step(joint)
        told.append(fingerprint(env, rewards, infos))
    return told


def fingerprint(env: Any, *told: Any) -> str:
    """World, facts, joint positions and what was told, bit by bit, as one short string."""
    world = env.world
    parts = [
        sorted(world.robots.items(), key=str),
        sorted((name, item.place, sorted(item.marks)) for name, item in world.objects.items()),
        sorted((name, item.door, sorted(item.on)) for name, item in world.fixtures.items()),
        [sorted((k, str(v)) for k, v in item.items() if k != "world") for item in told[:1]],
    ]
    digest = hashlib.sha256(repr(parts).encode())
    for info in told[1].values() if len(told) > 1 else ():
        digest.update(repr(sorted(info["outcome"].items())).encode())
    digest.update(env.state().tobytes())
    positions = env._backend.positions()
    digest.update(b"" if positions is None else positions.tobytes())
    return digest.hexdigest()[:16]


def plan(env: Any) -> list[dict[str, int]]:
    """The tokens of a shortest plan from here."""
    found = solve(env.start.scene, env.world, env.goal)
    if found is None:
        raise ValueError("this episode cannot be solved")
    return [{name: env.vocabulary.encode(s.text) for name, s in joint.items()} for joint in found.rounds]


def resident() -> int:
    """Memory in use by this process, bytes (Linux)."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * 4096


def growth(once: Callable[[int], None], *, warm: int, times: int) -> float:
    """Bytes by which memory has grown a call, after `warm` calls that may fill caches."""
    for number in range(warm):
        once(number)
    gc.collect()
    before = resident()
    for number in range(times):
        once(warm + number)
    gc.collect()
    return (resident() - before) / times
