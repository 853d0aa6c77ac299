"""check_events: under the event clock nobody is asked who is busy, time goes on, and what ended is told once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remac_env.testing.play import EnvMaker, Turn, expect, mask_of, opened, play, random_legal

if TYPE_CHECKING:
    from remac_env.envs.parallel import KitchenParallelEnv

FIELDS: Mapping[str, type] = {
    "ready": bool,
    "running": str,
    "elapsed": float,
    "seconds": float,
    "tau": float,
    "return": float,
    "outcome": dict,
    "decision": int,
    "continue": int,
}
"""What `infos[robot]` holds under the event clock beside the rest, and of which type."""

_NEAR = 1e-5


@dataclass
class _Seen:
    """What is known of a robot: when it decided last, what it has gained since, and how often it has decided."""

    decided: float = 0.0
    gained: float = 0.0
    count: int = 0


def check_events(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1, 2), steps: int = 60) -> None:
    """Play random legal episodes and look at who is asked when.

    A robot is ready when it has not been told anything yet, or when what it did has ended, and then alone; its outcome
    is told at that decision point and at no other, and lies between its decision and now. The mask of a busy robot
    holds `continue` and nothing else (`stop` too where `infos` name its token), that of a ready one the commands that
    it is told of. The clock goes on with every step but the last. `tau`, `return` and `decision` add up.

    Raises:
        ContractError: with the seed, the step and the robot at fault.
    """
    with opened(env_fn) as env:
        for seed in seeds:
            robots = {name: _Seen() for name in env.possible_agents}
            ready, clock = set(env.possible_agents), 0.0
            for turn in play(env, seed, random_legal(seed, env.vocabulary), rounds=steps):
                where = f"check_events, seed {seed}, step {turn.number}"
                for name in turn.alive:
                    _check_fields(turn.infos[name], f"{where}, {name}")
                for name in ready if turn.number else ():
                    robots[name] = _Seen(clock, 0.0, robots[name].count + 1)
                for name, reward in turn.rewards.items():
                    robots[name].gained += reward
                clock = _check_clock(turn, clock, where)
                ready = {name for name in turn.alive if turn.infos[name]["ready"]}
                for name in turn.alive:
                    _check_robot(env, turn, name, robots[name], f"{where}, {name}")


def _check_fields(info: Mapping[str, Any], where: str) -> None:
    for field, kind in FIELDS.items():
        expect(field in info, f"{where}: info lacks {field!r}")
        expect(type(info[field]) is kind, f"{where}: info[{field!r}] is a {type(info[field]).__name__}")


def _check_clock(turn: Turn, before: float, where: str) -> float:
    clocks = {turn.infos[name]["seconds"] for name in turn.alive}
    expect(len(clocks) == 1, f"{where}: the robots are told of different clocks: {sorted(clocks)}")
    now = float(clocks.pop())
    expect(math.isfinite(now) and now >= before, f"{where}: the clock shows {now} s after {before} s")
    expect(now > before or turn.number == 0 or turn.ended, f"{where}: time stands still at {now} s")
    return now


def _check_robot(env: KitchenParallelEnv, turn: Turn, name: str, seen: _Seen, where: str) -> None:
    info = turn.infos[name]
    _check_mask(env, turn, name, where)
    outcome, ready, now = info["outcome"], info["ready"], info["seconds"]
    if turn.number == 0:
        expect(ready and not outcome, f"{where}: at the start it is not ready, or told of {outcome}")
    elif not turn.ended:
        asked = f"{where}: it is asked, and nothing says that what it does has ended"
        expect(bool(outcome) or not ready, asked)
        expect(ready or not outcome, f"{where}: it is told of {outcome} and is busy")
    expect(bool(info["running"]) != ready or turn.ended, f"{where}: ready is {ready} and running {info['running']!r}")
    if outcome:
        inside = seen.decided - _NEAR <= outcome["began"] <= outcome["ended"] <= now + _NEAR
        expect(inside, f"{where}: told of {outcome} at {now} s, decided at {seen.decided} s")
    told = (info["tau"], info["return"], info["decision"])
    valid = (now - seen.decided, seen.gained, seen.count)
    right = all(abs(one - other) < _NEAR for one, other in zip(told, valid, strict=True))
    expect(right, f"{where}: tau, return and decision are {told}, not {valid}")


def _check_mask(env: KitchenParallelEnv, turn: Turn, name: str, where: str) -> None:
    info = turn.infos[name]
    marked = {env.vocabulary.decode(int(token)) for token in np.flatnonzero(mask_of(turn.observations[name], info))}
    expect(bool(marked), f"{where}: the mask is empty")
    if turn.ended:
        return
    busy = {"continue", "stop"} if "stop" in info else {"continue"}
    valid = set(info["commands"]) if info["ready"] else busy
    what = "ready" if info["ready"] else "busy"
    wrong = f"{where}: it is {what}, and its mask and what it may do differ in {sorted(marked ^ valid)}"
    expect(marked == valid, wrong)
