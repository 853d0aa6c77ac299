"""check_determinism: the same seed is the same episode, whatever came before and whatever global generators say."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from remac_env.testing.play import EnvMaker, Turn, arrays_of, expect, opened, play, random_legal

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv

Trace = list[dict[str, Any]]


def check_determinism(env_fn: EnvMaker, *, seeds: Sequence[int] = (0, 1, 2), rounds: int = 30) -> None:
    """Compare whole episodes with the same tokens: observations bit by bit, rewards, flags and infos.

    One environment plays the seeds in order. A second plays them in the opposite order, after episodes that were
    broken off, with other global random states; it also plays the first seed twice. Different seeds must start
    differently, and the global generators of `random` and NumPy must not be used.

    Raises:
        ContractError: with the seed, the round and the entry that differs.
    """
    with _global_random_kept(), opened(env_fn) as env:
        first = {seed: trace(env, seed, rounds=rounds) for seed in seeds}
    with _global_random_kept(), opened(env_fn) as env:
        env.reset(seed=max(seeds) + 1)
        for seed in [*reversed(seeds), *seeds[:1]]:
            where = f"check_determinism, seed {seed}"
            # The old global generators are set on purpose, to see that nobody listens to them or draws from them.
            random.seed(seed + 7)
            np.random.seed(seed + 7)  # noqa: NPY002
            before = _global_state()
            _compare(first[seed], trace(env, seed, rounds=rounds), where)
            expect(_global_state() == before, f"{where}: random numbers were drawn from a global generator")
            for _ in play(env, seed + 1, random_legal(seed, env.vocabulary), rounds=1):
                pass
    digests = {tuple(info["episode"]["digest"] for info in first[seed][0]["infos"].values()) for seed in seeds}
    expect(len(seeds) < 2 or len(digests) > 1, f"check_determinism: the seeds {list(seeds)} all start the same")


def trace(env: KitchenParallelEnv, seed: int, *, rounds: int) -> Trace:
    """Everything that an episode with random legal tokens returned, arrays copied."""
    choose = random_legal(seed, env.vocabulary)
    return [_copied(turn) for turn in play(env, seed, choose, rounds=rounds)]


def _copied(turn: Turn) -> dict[str, Any]:
    seen = {robot: {k: np.array(v) for k, v in arrays_of(o).items()} for robot, o in turn.observations.items()}
    return {
        "tokens": dict(turn.tokens),
        "observations": seen,
        "rewards": dict(turn.rewards),
        "terminations": dict(turn.terminations),
        "truncations": dict(turn.truncations),
        "infos": {robot: dict(info) for robot, info in turn.infos.items()},
    }


def _compare(first: Trace, second: Trace, where: str) -> None:
    for number, (one, other) in enumerate(zip(first, second, strict=False)):
        for key in ("observations", "infos", "rewards", "terminations", "truncations", "tokens"):
            path = difference(one[key], other[key])
            expect(path is None, f"{where}, round {number}: {key}{path} differs from the same episode before")
    expect(len(first) == len(second), f"{where}: {len(first) - 1} rounds, then {len(second) - 1}")


def difference(one: Any, other: Any) -> str | None:
    """The path to the first entry in which two nested values differ, or None; NaN never equals anything."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return None if one.dtype == other.dtype and np.array_equal(one, other) else ""
    if type(one) is dict and type(other) is dict:
        if set(one) != set(other):
            return f"{sorted(set(one) ^ set(other))}"
        return _in_mapping(one, other)
    return None if one == other else ""


def _in_mapping(one: Mapping[str, Any], other: Mapping[str, Any]) -> str | None:
    for key, value in one.items():
        path = difference(value, other[key])
        if path is not None:
            return f"[{key!r}]{path}"
    return None


def _global_state() -> tuple[object, ...]:
    kind, keys, *rest = np.random.get_state()  # noqa: NPY002
    return random.getstate(), kind, np.asarray(keys).tobytes(), tuple(rest)


@contextmanager
def _global_random_kept() -> Iterator[None]:
    """Put the global generators back in the end."""
    plain, numpy = random.getstate(), np.random.get_state()  # noqa: NPY002
    try:
        yield
    finally:
        random.setstate(plain)
        np.random.set_state(numpy)  # noqa: NPY002
