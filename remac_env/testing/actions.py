"""check_masks and check_actions: illegal tokens cost a round, malformed actions raise and change nothing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from remac_env.testing.determinism import difference, trace
from remac_env.testing.play import ContractError, EnvMaker, Tokens, expect, mask_of, opened

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv

MALFORMED: tuple[Any, ...] = (float("nan"), float("inf"), 1.5, 1.0, None, "wait", True, 1j, [0], np.ones(2), {})
"""Values that are no tokens."""


def check_masks(env_fn: EnvMaker, *, seeds: Iterable[int] = (0,), limit: int | None = None) -> None:
    """Try every token from the start of an episode.

    The mask is int8 zeros and ones, as long as the vocabulary, and marks exactly the commands that the robot is told
    of; `wait` and `done` are legal. A masked token, or a number that is no token at all, is a lost round: outcome
    `invalid`, the world as before. A legal token never is `invalid`. None of them raises.

    Args:
        env_fn: makes a new environment.
        seeds: of the starts.
        limit: how many legal and how many masked tokens are tried, evenly chosen; None for all (slow in physics).

    Raises:
        ContractError: with the token at fault.
    """
    with opened(env_fn) as env:
        size = len(env.vocabulary)
        for seed in seeds:
            observations, infos = env.reset(seed=seed)
            for name, seen in observations.items():
                _check_mask(env, mask_of(seen, infos[name]), infos[name], f"check_masks, seed {seed}, {name}")
            mask = np.asarray(mask_of(seen, infos[name]))
            strange = [-1, size, size + 1000, 2**70, -(2**70)]
            for token in [*_some(np.flatnonzero(mask == 0), limit), *strange]:
                _check_round(env, seed, token, legal=False)
            for token in _some(np.flatnonzero(mask), limit):
                _check_round(env, seed, token, legal=True)


def _some(tokens: np.ndarray, limit: int | None) -> list[int]:
    if limit is not None and limit < len(tokens):
        tokens = tokens[np.linspace(0, len(tokens) - 1, limit).round().astype(int)]
    return [int(token) for token in tokens]


def _check_mask(env: KitchenParallelEnv, mask: np.ndarray, info: Mapping[str, Any], where: str) -> None:
    expect(isinstance(mask, np.ndarray), f"{where}: the mask is a {type(mask).__name__}, not an array")
    size = len(env.vocabulary)
    expect(mask.dtype == np.int8, f"{where}: the mask has dtype {mask.dtype}; valid: int8")
    expect(mask.shape == (size,), f"{where}: the mask has shape {mask.shape}; valid: {(size,)}")
    expect(np.isin(mask, (0, 1)).all(), f"{where}: the mask holds other values than 0 and 1")
    for command in ("wait", "done"):
        expect(mask[env.vocabulary.encode(command)] == 1, f"{where}: {command!r} is masked")
    marked = [env.vocabulary.decode(int(token)) for token in np.flatnonzero(mask)]
    wrong = set(marked) ^ set(info["commands"])
    expect(not wrong, f"{where}: {sorted(wrong)} are marked or told, but not both")


def _check_round(env: KitchenParallelEnv, seed: int, token: int, *, legal: bool) -> None:
    """Each robot in turn gives the token, the others wait."""
    for name in env.possible_agents:
        where = f"check_masks, seed {seed}, {name}, {'legal' if legal else 'illegal'} token {token}"
        _, before = env.reset(seed=seed)
        tokens = dict.fromkeys(env.agents, env.vocabulary.encode("wait"))
        try:
            _, rewards, _, _, infos = env.step(tokens | {name: token})
        except Exception as error:
            raise ContractError(f"{where}: step() raised {error!r}") from error
        invalid = infos[name]["outcome"]["reason"] == "invalid"
        expect(invalid != legal, f"{where}: outcome {infos[name]['outcome']}")
        if not legal:
            same = infos[name]["world"] == before[name]["world"]
            expect(same and rewards[name] == 0, f"{where}: the world has changed, or it brought a reward")


def check_actions(env_fn: EnvMaker, *, seed: int = 0, rounds: int = 4) -> None:
    """Give step() malformed actions: NaN, floats, None, texts, flags, lists; robots missing, unknown, none at all.

    Each must raise an exception whose message names the robot at fault, and change nothing: the episode afterwards is
    the one that it is without them.

    Raises:
        ContractError: with the action that was accepted, or after which something differs.
    """
    with opened(env_fn) as env:
        undisturbed = trace(env, seed, rounds=rounds)
    with opened(env_fn) as env:
        env.reset(seed=seed)
        agents, wait = tuple(env.agents), env.vocabulary.encode("wait")
        fine: Tokens = dict.fromkeys(agents, wait)
        for name in agents:
            for value in MALFORMED:
                _check_refused(env, {**fine, name: value}, name)
            _check_refused(env, {other: token for other, token in fine.items() if other != name}, name)
        _check_refused(env, fine | {"robot_9": wait}, "robot_9")
        none_at_all: tuple[Any, ...] = ({}, None, wait, [wait] * len(agents))
        for actions in none_at_all:
            _check_refused(env, actions, *agents)
        tokens = [turn["tokens"] for turn in undisturbed[1:]]
        for number, step in enumerate(tokens, start=1):
            observations, rewards, *_, infos = env.step(step)
            answer = {"observations": observations, "rewards": rewards, "infos": infos}
            for key, value in answer.items():
                path = difference(undisturbed[number][key], value)
                expect(
                    path is None,
                    f"check_actions, seed {seed}: after malformed actions {key}{path} of round {number} differs",
                )


def _check_refused(env: KitchenParallelEnv, actions: Any, *names: str) -> None:
    where = f"check_actions: step({actions!r})"
    alive = list(env.agents)
    try:
        env.step(actions)
    except Exception as error:  # noqa: BLE001 - any exception will do, as long as it names the robot
        text = str(error)
        expect(all(name in text for name in names), f"{where} raised {error!r}, which does not name {list(names)}")
    else:
        raise ContractError(f"{where} was accepted")
    expect(env.agents == alive, f"{where} changed the robots alive to {env.agents}")
