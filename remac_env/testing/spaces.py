"""check_spaces: everything that reset and step return has the promised keys, types and ranges."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces

from remac_env.rules.outcomes import REASONS
from remac_env.state import WorldState
from remac_env.testing.play import WHOLE, EnvMaker, Turn, arrays_of, expect, opened, play, random_legal
from remac_env.testing.world import check_world

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv

INFO_TYPES: Mapping[str, type] = {
    "outcome": dict,
    "text": str,
    "goal": str,
    "episode": dict,
    "success": bool,
    "world": WorldState,
}
"""What `infos[robot]` holds at least, and of which type."""

EPISODE_FIELDS = ("task", "style", "layout", "starts", "seed", "digest")
OUTCOME_FIELDS = ("status", "reason", "detail", "seconds", "began", "ended")


_CENTS = 0.02
"""s: times are told in hundredths of a second."""


def check_spaces(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1), rounds: int = 30) -> None:
    """Play whole random legal episodes and look at all that comes back.

    Observations lie in their spaces with the same keys, dtypes and shapes; the dicts hold exactly the robots that were
    alive before the step; infos have all fields, each always of one type; rewards are finite floats and
    flags bools; robots end together; spaces stay the same objects; arrays once returned are not written to again; the
    world is whole.

    Raises:
        ContractError: with the seed, the round and the robot at fault.
    """
    with opened(env_fn) as env:
        kept = {name: (env.observation_space(name), env.action_space(name)) for name in env.possible_agents}
        types: dict[str, type] = {}
        for seed in seeds:
            older: list[tuple[np.ndarray, np.ndarray]] = []
            for turn in play(env, seed, random_legal(seed, env.vocabulary), rounds=rounds):
                where = f"check_spaces, seed {seed}, round {turn.number}"
                _check_turn(env, turn, where)
                _check_types(turn, types, where)
                reused = any(not np.array_equal(array, copy) for array, copy in older)
                expect(not reused, f"{where}: an observation returned earlier was written to")
                arrays = [array for seen in turn.observations.values() for array in arrays_of(seen).values()]
                older = [(array, array.copy()) for array in arrays]
        for name, (seen, acted) in kept.items():
            same = env.observation_space(name) is seen and env.action_space(name) is acted
            expect(same, f"check_spaces: the spaces of {name} are not the same objects at every call")


def _check_turn(env: KitchenParallelEnv, turn: Turn, where: str) -> None:
    expect(turn.alive, f"{where}: no robot is alive")
    told = {"observations": turn.observations, "infos": turn.infos}
    if turn.number:
        told |= {"rewards": turn.rewards, "terminations": turn.terminations, "truncations": turn.truncations}
    for what, values in told.items():
        expect(isinstance(values, dict), f"{where}: {what} is a {type(values).__name__}, not a dict")
        given = set(values)
        expect(given == set(turn.alive), f"{where}: {what} of {sorted(given)}, but alive were {list(turn.alive)}")
    for name in turn.alive:
        _check_observation(turn.observations[name], env.observation_space(name), f"{where}, {name}")
        _check_info(turn, name, f"{where}, {name}")
    _check_flags(env, turn, where)
    worlds = {info["world"] for info in turn.infos.values()}
    expect(len(worlds) == 1, f"{where}: the robots are told of different worlds")
    for info in turn.infos.values():
        check_world(info["scene"], info["world"], where=where)


def _check_observation(seen: object, space: spaces.Space[Any], where: str) -> None:
    flat = isinstance(space, spaces.Box)
    expect(flat or isinstance(space, spaces.Dict), f"{where}: the observation space is no Dict and no Box: {space}")
    expect(flat or isinstance(seen, dict), f"{where}: the observation is a {type(seen).__name__}, not a dict")
    parts: Mapping[str, Any] = {WHOLE: space} if flat else space.spaces  # type: ignore[attr-defined]
    observation = arrays_of(seen)
    wrong = set(observation) ^ set(parts)
    expect(not wrong, f"{where}: keys {sorted(wrong)} are in the observation or in its space, but not in both")
    for key, part in parts.items():
        value = observation[key]
        expect(isinstance(value, np.ndarray), f"{where}: {key} is a {type(value).__name__}, not an array")
        expect(value.dtype == part.dtype, f"{where}: {key} has dtype {value.dtype}, its space {part.dtype}")
        expect(value.shape == part.shape, f"{where}: {key} has shape {value.shape}, its space {part.shape}")
        expect(part.contains(value), f"{where}: {key} lies outside its space {part}")


def _check_info(turn: Turn, name: str, where: str) -> None:
    info = turn.infos[name]
    for field, kind in INFO_TYPES.items():
        expect(field in info, f"{where}: info lacks {field!r}")
        expect(isinstance(info[field], kind), f"{where}: info[{field!r}] is a {type(info[field]).__name__}")
    lacking = [field for field in EPISODE_FIELDS if field not in info["episode"]]
    expect(not lacking, f"{where}: info['episode'] lacks {lacking}")
    outcome = info["outcome"]
    told = turn.number > 0 and info.get("ready", True)  # by the event clock only once it has ended
    expect(bool(outcome) or not told, f"{where}: info['outcome'] is {outcome!r}")
    expect(not outcome or turn.number > 0, f"{where}: info['outcome'] is {outcome!r}")
    if not outcome:
        return
    lacking = [field for field in OUTCOME_FIELDS if field not in outcome]
    expect(not lacking, f"{where}: info['outcome'] lacks {lacking}")
    status, reason = outcome["status"], outcome["reason"]
    expect(status in ("success", "failure"), f"{where}: status {status!r}")
    valid = reason == "" if status == "success" else reason in REASONS
    expect(valid, f"{where}: reason {reason!r} with status {status!r}; valid reasons: {', '.join(REASONS)}")
    for field in ("seconds", "began", "ended"):
        value = outcome[field]
        timed = isinstance(value, float) and math.isfinite(value) and value >= 0
        expect(timed, f"{where}: {field} {value!r}")
    began, ended, seconds = outcome["began"], outcome["ended"], outcome["seconds"]
    expect(abs(ended - began - seconds) < _CENTS, f"{where}: {seconds} s from {began} s to {ended} s")


def _check_types(turn: Turn, types: dict[str, type], where: str) -> None:
    """Every value in the infos is of the type that it had before, or vector environments cannot put them together."""
    for info in turn.infos.values():
        for path, value in _leaves(info):
            kind = types.setdefault(path, type(value))
            changed = f"is a {type(value).__name__} and was a {kind.__name__}"
            expect(type(value) is kind, f"{where}: info{path} {changed}; valid: one type for every key")


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of nested dicts, the dicts among them, with its keys: "['episode']['seed']"."""
    if path:
        yield path, value
    if isinstance(value, dict):
        for key, part in value.items():
            yield from _leaves(part, f"{path}[{key!r}]")


def _check_flags(env: KitchenParallelEnv, turn: Turn, where: str) -> None:
    for name, reward in turn.rewards.items():
        fine = isinstance(reward, float) and math.isfinite(reward)
        expect(fine, f"{where}: the reward of {name} is {reward!r} ({type(reward).__name__}), not a finite float")
    for flags in (turn.terminations, turn.truncations):
        for name, flag in flags.items():
            expect(type(flag) is bool, f"{where}: a flag of {name} is {flag!r} ({type(flag).__name__}), not a bool")
    if not turn.number:
        return
    ends = {(turn.terminations[name], turn.truncations[name]) for name in turn.alive}
    expect(len(ends) == 1, f"{where}: the robots do not end together: {turn.terminations}, {turn.truncations}")
    expect((True, True) not in ends, f"{where}: terminated and truncated at once")
    left = () if turn.ended else turn.alive
    expect(tuple(env.agents) == left, f"{where}: agents are {env.agents}, not {list(left)}")
