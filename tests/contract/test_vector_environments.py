"""Gymnasium's vector environments of kitchens that end at different times, in every mode of starting anew."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
import numpy as np
import pytest
from bad_environments import EndsInNone, NoOutcomeYet, Tampered
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv, VectorEnv

from remac_env.envs.gym_view import KitchenEnv

ROUNDS = (2, 5)
"""`max_rounds` of the two kitchens: one begins anew while the other goes on."""

KINDS: Mapping[str, Callable[..., VectorEnv[Any, Any, Any]]] = {
    "sync": SyncVectorEnv,
    "async": AsyncVectorEnv,
    "spawned": lambda makers, **options: AsyncVectorEnv(makers, context="spawn", **options),
}


def maker(robots: int, rounds: int, **options: Any) -> Callable[[], Any]:
    return _Maker({"robots": robots, "max_rounds": rounds, "backend": "symbolic"} | options)


class _Maker:
    """Makes a kitchen; spawned processes get it pickled."""

    def __init__(self, options: dict[str, Any]) -> None:
        self.options = options

    def __call__(self) -> gymnasium.Env[Any, Any]:
        return gymnasium.make("RemacKitchen-OpenCabinetPnP-v0", **self.options)


def play(env: VectorEnv[Any, Any, Any], mode: AutoresetMode, rounds: int = 11) -> list[dict[str, Any]]:
    """The infos of a reset and of rounds in which everybody waits."""
    told = [env.reset(seed=[3, 4])[1]]
    for _ in range(rounds):
        _, _, terminations, truncations, infos = env.step(np.zeros(env.action_space.shape, np.int64))
        told.append(infos)
        over = np.logical_or(terminations, truncations)
        if mode is AutoresetMode.DISABLED and over.any():
            told.append(env.reset(options={"reset_mask": over})[1])
    env.close()
    return told


@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("robots", [1, 2])
@pytest.mark.parametrize("kind", ["sync", "async", pytest.param("spawned", marks=pytest.mark.long)])
def test_kitchens_that_end_at_different_times(kind: str, robots: int, mode: AutoresetMode) -> None:
    env = KINDS[kind]([maker(robots, rounds) for rounds in ROUNDS], autoreset_mode=mode)
    told = play(env, mode)
    for number in range(robots):
        first = told[0]["robots"][f"robot_{number}"]
        assert list(first["end"]) == ["", ""] and first["_outcome"].all() and first["round"].dtype == np.int64
        ends = [end for infos in told for end in _ends(infos, f"robot_{number}")]
        assert ends.count("truncated") >= 3, ends
        assert set(ends) <= {"truncated", "", None}


@pytest.mark.parametrize("kind", ["sync", "async"])
def test_vectors_and_masks_of_learners_in_the_step_of_a_new_beginning(kind: str) -> None:
    makers = [maker(2, rounds, obs_format="flat", masks="feasible", reward="distance") for rounds in ROUNDS]
    env = KINDS[kind](makers, autoreset_mode=AutoresetMode.SAME_STEP)
    seen, _ = env.reset(seed=[3, 4])
    ends = 0
    for number in range(1, 6):
        assert seen in env.observation_space
        masks = np.stack(env.call("action_masks"))
        assert masks.shape == (2, 2 * int(env.single_action_space.nvec[0])) and masks.dtype == bool  # type: ignore[attr-defined]
        seen, *_, infos = env.step(np.zeros((2, 2), np.int64))
        for at in np.flatnonzero(infos.get("_final_obs", ())):
            ends += 1
            assert number % ROUNDS[at] == 0 and not np.array_equal(infos["final_obs"][at], seen[at])
    assert ends == 3
    env.close()


def _ends(infos: Mapping[str, Any], robot: str) -> list[str]:
    """How episodes stood, in the infos and in those of episodes that ended in the same step."""
    found = []
    for part in (infos, infos.get("final_info", {})):
        if "robots" in part and robot in part["robots"]:
            found += list(part["robots"][robot]["end"])
    return found


def test_several_layouts_tasks_and_rewards_go_together() -> None:
    makers = [
        maker(2, 3, layout="galley", reward="progress", starts="mixed"),
        maker(2, 4, layout="one_wall_small", failure_rate=0.5),
        lambda: gymnasium.make("RemacKitchen-DefrostInBowl-v0", backend="symbolic", robots=2, max_rounds=2),
    ]
    env = SyncVectorEnv(makers)
    env.reset(seed=5)
    chance = np.random.default_rng(0)
    for _ in range(12):
        actions = chance.integers(2, 40, env.action_space.shape)
        *_, infos = env.step(actions)
        outcomes = infos["robots"]["robot_1"]["outcome"]
        assert outcomes["seconds"].dtype == np.float64 and set(outcomes["status"]) <= {"success", "failure", None}
    env.close()


class _Wrong(KitchenEnv):
    """The Gymnasium view of a kitchen that is wrong on purpose."""

    def __init__(self, kind: type[Tampered], rounds: int) -> None:
        super().__init__("OpenCabinetPnP", robots=2, backend="symbolic", max_rounds=rounds)
        self.parallel = kind(max_rounds=rounds)


def test_a_kitchen_without_an_outcome_at_reset_does_not_go_with_others() -> None:
    """Or else the tests above would prove nothing."""
    play(SyncVectorEnv([lambda n=n: _Wrong(Tampered, n) for n in ROUNDS]), AutoresetMode.NEXT_STEP)
    with pytest.raises((AttributeError, TypeError)):
        play(SyncVectorEnv([lambda n=n: _Wrong(NoOutcomeYet, n) for n in ROUNDS]), AutoresetMode.NEXT_STEP)
    ends = play(SyncVectorEnv([lambda n=n: _Wrong(EndsInNone, n) for n in ROUNDS]), AutoresetMode.NEXT_STEP)
    assert list(ends[0]["robots"]["robot_0"]["end"]) != ["", ""]
