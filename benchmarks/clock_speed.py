"""What a simulated second costs by both clocks: the same plans of two robots.

Part of `python benchmarks/speed.py --only clocks`. With rounds a robot waits for the end of the round; by the event
clock it is told its plan's next command as soon as all have ended that other robots were to do in earlier rounds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from statistics import median
from time import process_time
from typing import Any

from event_turns import Infos, turns

import remac_env
from remac_env.oracle import solve
from remac_env.rules.subtasks import WAIT, Subtask

TASKS = ("OpenMicrowavePnP", "DefrostInBowl")
EPISODES = {"symbolic": 40, "physics": 1}
"""How often each plan is played, so that there is something to measure."""

Rounds = Sequence[Mapping[str, Subtask]]


def rates(backend: str, seeds: Sequence[int]) -> dict[str, float]:
    """Clock -> simulated seconds for each second of CPU time in `step`, the median over tasks and seeds."""
    found: dict[str, list[float]] = {"rounds": [], "events": []}
    for task in TASKS:
        for clock in found:
            env = remac_env.parallel_env(task, robots=2, backend=backend, clock=clock)
            for seed in seeds:
                steps = _steps(env, seed, clock)  # and everything is warm
                runs = [_play(env, seed, steps) for _ in range(EPISODES[backend])]
                found[clock].append(sum(told for told, _ in runs) / sum(spent for _, spent in runs))
            env.close()
    return {clock: median(each) for clock, each in found.items()}


def _play(env: Any, seed: int, steps: Sequence[Mapping[str, int]]) -> tuple[float, float]:
    """Simulated seconds and CPU seconds of an episode with these tokens."""
    env.reset(seed=seed)
    began = process_time()
    for tokens in steps:
        infos = env.step(tokens)[4]
    return infos["robot_0"]["seconds"], process_time() - began


def _steps(env: Any, seed: int, clock: str) -> list[Mapping[str, int]]:
    """The tokens of each step of an episode: what chooses them is no part of what is measured."""
    _, infos = env.reset(seed=seed)
    joints, told = _plan(env, env.worlds.spec.name, seed), _Told(env)
    for _ in _by_events(told, infos, joints) if clock == "events" else _by_rounds(told, infos, joints):
        pass
    return told.steps


class _Told:
    """An environment that keeps what it was told."""

    def __init__(self, env: Any) -> None:
        self._env, self.steps = env, list[Mapping[str, int]]()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._env, name)

    def step(self, tokens: Mapping[str, int]) -> Any:
        self.steps.append(tokens)
        return self._env.step(tokens)


_PLANS: dict[tuple[str, int], Rounds] = {}


def _plan(env: Any, task: str, seed: int) -> Rounds:
    if (task, seed) not in _PLANS:
        found = solve(env.start.scene, env.start.world, env.goal)
        if found is None:
            raise RuntimeError(f"{task} with seed {seed} has no plan")
        _PLANS[task, seed] = found.rounds
    return _PLANS[task, seed]


def _by_rounds(env: Any, infos: Any, joints: Rounds) -> Iterator[Any]:
    for joint in joints:
        if env.agents:
            yield env.step({robot: env.vocabulary.encode(step.text) for robot, step in joint.items()})[4]


def _by_events(env: Any, infos: Any, joints: Rounds) -> Iterator[Any]:
    """A robot begins its command of a round once all commands of the rounds before have ended, waits left out."""
    rounds = iter(joints)
    at: set[str] = set()

    def choose(ready: Sequence[str], infos: Infos) -> dict[str, int]:
        at.difference_update(ready)
        if at:
            return {}
        begun = {r: env.vocabulary.encode(step.text) for r, step in next(rounds, {}).items() if step != WAIT}
        at.update(begun)
        return begun

    yield from turns(env, infos, choose)
