"""Copies in the middle of an episode by events go on alike, whatever is done to what the kitchen has handed out."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import remac_env
from remac_env.event_episode import EventEpisode
from remac_env.observation import Facts
from remac_env.thinking import Thought

COPIERS: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda env: pickle.loads(pickle.dumps(env)),
    "deep": copy.deepcopy,
}
KINDS: tuple[dict[str, Any], ...] = (
    {"task": "RinseAndStow", "robots": 2, "interrupts": True, "think": "tokens:7"},
    {"task": "DefrostInBowl", "robots": 3, "failure_rate": 0.3, "knowledge": "seen", "text": "states"},
    {"task": "FallingDoor", "robots": 2, "obs_format": "flat", "masks": "feasible"},
)


def plain(value: Any) -> Any:
    """Something that is equal only where the value is, bit by bit; worlds are compared by their own means."""
    if isinstance(value, dict):
        return {key: plain(each) for key, each in value.items() if key != "scene"}
    if isinstance(value, tuple | list):
        return [plain(each) for each in value]
    return (value.dtype.str, value.shape, value.tobytes()) if isinstance(value, np.ndarray) else value


def spoil(value: Any) -> None:
    """Change all that can be changed of what was handed out."""
    if isinstance(value, np.ndarray):
        value[:] = 1 - value
    elif type(value) is dict:
        for each in value.values():
            spoil(each)
        value.clear()
    elif isinstance(value, list | tuple):
        for each in value:
            spoil(each)


def draw(env: Any, infos: Any, chance: np.random.Generator) -> tuple[dict[str, int], dict[str, Thought]]:
    """Tokens and thoughts for a step, legal ones by the masks or any at all."""
    thoughts = {name: Thought(int(chance.integers(900))) for name in env.agents if infos[name]["ready"]}
    masks = {robot: np.flatnonzero(env.action_mask(robot)) for robot in env.agents}
    done = env.vocabulary.encode("done")
    tokens = {robot: int(chance.choice(mask[mask != done])) for robot, mask in masks.items()}
    return tokens, thoughts


def check(env: Any, how: str, steps: int = 30) -> None:
    """Play at random beside a copy, and copies of it, of which all that is handed out is spoilt."""
    chance, other = np.random.default_rng(5), COPIERS[how](env)
    _, infos = env.reset(seed=198800)
    spoil(other.reset(seed=198800))
    for _ in range(steps):
        if not env.agents:
            break
        tokens, thoughts = draw(env, infos, chance)
        other = COPIERS[how](other) if chance.random() < 0.2 else other
        answers = []
        for each in (env, other):
            for robot, thought in thoughts.items():
                each.note_thought(robot, thought)
            answers.append(each.step(tokens))
        assert plain(answers[0]) == plain(answers[1])
        assert (env.timeline, env.progress) == (other.timeline, other.progress)
        spoil(answers[1])
        infos = answers[0][4]


@pytest.mark.parametrize("how", COPIERS)
@pytest.mark.parametrize("kind", KINDS, ids=[kind["task"] for kind in KINDS])
def test_copies_go_on_alike_whatever_is_done_to_what_was_told(kind: dict[str, Any], how: str) -> None:
    check(remac_env.parallel_env(**kind, backend="symbolic", clock="events", max_seconds=400.0), how)


def shared_commands(self: EventEpisode, robot: str) -> dict[str, Any]:
    return {**OWN(self, robot), "commands": self.terms.commands}


def shared_vectors(self: Facts, scene: Any, world: Any, robots: Any) -> dict[str, Any]:
    VECTORS(self, scene, world, robots)
    return {robot: self._kitchen.values[robot] for robot in robots}


OWN, VECTORS = EventEpisode._own, Facts.vectors


@pytest.mark.parametrize(("where", "name", "wrong"), [
    (EventEpisode, "_own", shared_commands), (Facts, "vectors", shared_vectors),
], ids=["commands", "vectors"])  # fmt: skip
def test_what_is_not_handed_out_as_a_copy_is_found(
    where: type, name: str, wrong: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(where, name, wrong)
    with pytest.raises(AssertionError):
        check(remac_env.parallel_env(**KINDS[0], backend="symbolic", clock="events", max_seconds=400.0), "deep")
