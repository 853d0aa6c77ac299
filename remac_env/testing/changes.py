"""check_changes: no observation is constant; what a robot sees changes while the world does."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from remac_env.testing.play import EnvMaker, Turn, arrays_of, expect, opened, play, random_legal

STEADY = ("action_mask",)
"""Parts of an observation that may stay the same: masks say what can be told to a robot, not how the world is."""


def check_changes(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1), rounds: int = 30) -> None:
    """Play random legal episodes: each part of each robot's observation changes in them, but for the masks.

    And each robot's observation changes again after it first did, so that one that stands still later is found out too.
    An episode in which the world changes fewer than four times proves nothing and is refused.

    Raises:
        ContractError: with the seed, the robot and the part that stays the same.
    """
    with opened(env_fn) as env:
        for seed in seeds:
            where = f"check_changes, seed {seed}"
            turns = list(play(env, seed, random_legal(seed, env.vocabulary), rounds=rounds))
            moved = [turn for before, turn in zip(turns, turns[1:], strict=False) if _world(before) != _world(turn)]
            expect(len(moved) >= 4, f"{where}: the world changes in {len(moved)} of {len(turns) - 1} rounds; play more")
            late = [turn for turn in turns if turn.number >= moved[len(moved) // 2 - 1].number]
            for part, shown in (("", turns), (f" from round {late[0].number} on", late)):
                for name in env.possible_agents:
                    for key in arrays_of(turns[0].observations[name]):
                        told = f"{where}, {name}: {key} is constant{part}, while the world changes"
                        expect(key in STEADY or _changes(shown, name, key), told)


def _world(turn: Turn) -> object:
    return next(iter(turn.infos.values()))["world"]


def _changes(turns: list[Turn], name: str, key: str) -> bool:
    first, *others = (np.asarray(arrays_of(turn.observations[name])[key]) for turn in turns)
    return any(not np.array_equal(first, other) for other in others)
