"""What all checks share: their error, and episodes played with seeded tokens."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remac_env.seeding import generator
from remac_env.vocabulary import Vocabulary

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv

EnvMaker = Callable[[], "KitchenParallelEnv"]
"""Makes a fresh environment at each call."""

Tokens = dict[str, int]


class ContractError(AssertionError):
    """An environment does not keep its contract; the message names the check, the seed and the round."""


def expect(true: object, message: str) -> None:
    """Raise ContractError with `message` unless `true`."""
    if not true:
        raise ContractError(message)


@contextmanager
def opened(env_fn: EnvMaker) -> Iterator[KitchenParallelEnv]:
    """A fresh environment that is closed in the end."""
    env = env_fn()
    try:
        yield env
    finally:
        env.close()


@dataclass(frozen=True)
class Turn:
    """One answer of an environment: of reset (number 0; no tokens, rewards or flags), or of step number 1, 2, ...

    `alive` are the robots that were alive before the step, or after the reset.
    """

    number: int
    alive: tuple[str, ...]
    observations: Mapping[str, Any]
    infos: Mapping[str, Any]
    tokens: Mapping[str, int]
    rewards: Mapping[str, Any]
    terminations: Mapping[str, Any]
    truncations: Mapping[str, Any]

    @property
    def ended(self) -> bool:
        """True when a robot's episode ended with this turn."""
        return any((*self.terminations.values(), *self.truncations.values()))


Choice = Callable[[Turn], Tokens]


def play(env: KitchenParallelEnv, seed: int, choose: Choice, *, rounds: int) -> Iterator[Turn]:
    """Reset with the seed and step with the chosen tokens, at most `rounds` times; yields every answer."""
    observations, infos = env.reset(seed=seed)
    turn = Turn(0, tuple(env.agents), observations, infos, {}, {}, {}, {})
    yield turn
    while turn.number < rounds and env.agents:
        alive, tokens = tuple(env.agents), choose(turn)
        answer = env.step(tokens)
        expect(len(answer) == 5, f"seed {seed}, round {turn.number + 1}: step() returned {len(answer)} values, not 5")
        observations, rewards, terminations, truncations, infos = answer
        turn = Turn(turn.number + 1, alive, observations, infos, tokens, rewards, terminations, truncations)
        yield turn


def random_legal(seed: int, vocabulary: Vocabulary) -> Choice:
    """Legal tokens drawn from a seeded generator; two of three are ones whose requirements hold just now.

    Tokens drawn from the mask alone hardly ever get anything done, so the checks would see one state all the time.
    """
    chance = generator(seed, "remac_env.testing")
    done = vocabulary.encode("done")

    def choose(turn: Turn) -> Tokens:
        tokens = {}
        for name in turn.alive:
            legal = [int(t) for t in np.flatnonzero(mask_of(turn.observations[name], turn.infos[name])) if t != done]
            workable = [token for token in legal if _workable(vocabulary, token, turn.infos[name], name)]
            pool = workable if workable and chance.random() < 2 / 3 else legal
            tokens[name] = pool[int(chance.integers(len(pool)))]
        return tokens

    return choose


WHOLE = "observation"
"""What an observation without keys is called."""


def arrays_of(observation: object) -> Mapping[str, Any]:
    """The arrays of an observation by key."""
    return observation if isinstance(observation, dict) else {WHOLE: observation}


def mask_of(observation: Any, info: Mapping[str, Any]) -> Any:
    """A robot's action mask: a part of its observation, or of its info where the observation is a vector alone."""
    return (observation if isinstance(observation, Mapping) else info)["action_mask"]


def scripted(script: list[Tokens], *, otherwise: int) -> Choice:
    """The tokens of a list, round by round, then `otherwise` for everybody."""

    def choose(turn: Turn) -> Tokens:
        later = turn.number >= len(script)
        return dict.fromkeys(turn.alive, otherwise) if later else script[turn.number]

    return choose


def _workable(vocabulary: Vocabulary, token: int, info: Mapping[str, Any], robot: str) -> bool:
    if vocabulary.word(token) is not None:
        return False
    subtask = vocabulary.subtask(token)
    if subtask.skill == "wait":
        return False
    return all(needed.condition.holds(info["scene"], info["world"]) for needed in subtask.requirements(robot))
