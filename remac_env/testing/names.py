"""check_names: no robot is number zero."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from remac_env.oracle import solve
from remac_env.seeding import generator
from remac_env.state import FrozenMap, Place, WorldState
from remac_env.tasks.goals import lost, progress
from remac_env.testing.play import Choice, EnvMaker, Tokens, Turn, expect, mask_of, opened, play, random_legal, scripted

FEW_STATES = 2_000
"""States in which a shortest plan is searched for; then any plan will do, so that the check stays quick."""


def check_names(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1), rounds: int = 30, replay: bool = True) -> None:
    """Swap the two robots' actions: the robots are swapped in the result, and the verdict is the same.

    Plays random legal episodes, a plan that reaches the goal, and rounds in which both robots are given the same token.

    Args:
        replay: play the swapped actions as well and compare every round. Leave it out in physics, where robots that
            start from different places need not do equally well; then only goal, loss and progress are judged on
            swapped worlds.

    Raises:
        ContractError: with the seed and the round in which the two differ.
    """
    for seed in seeds:
        with opened(env_fn) as env:
            if len(env.possible_agents) < 2:
                return
            vocabulary = env.vocabulary
            turns = _judged(env_fn, seed, random_legal(seed, vocabulary), rounds)
            observations, infos = env.reset(seed=seed)
            plan = solve(env.start.scene, env.world, env.goal, max_states=FEW_STATES)
            mask = mask_of(observations[env.agents[-1]], infos[env.agents[-1]])
            tokens = [int(token) for token in np.flatnonzero(mask) if token != vocabulary.encode("done")]
            shuffled = generator(seed, "check_names").permutation(tokens)[:rounds]
        scripts = [
            [dict(turn.tokens) for turn in turns[1:]],
            [dict.fromkeys(turns[0].alive, int(token)) for token in shuffled],
        ]
        if plan is not None:
            scripts.append([{r: vocabulary.encode(s.text) for r, s in joint.items()} for joint in plan.rounds])
        if replay:
            for script in scripts:
                _check_replay(env_fn, seed, script, vocabulary.encode("wait"))


def swap_robots(world: WorldState) -> WorldState:
    """The world of two robots with their names exchanged."""
    first, second = world.robots
    other = {first: second, second: first}
    objects = {
        name: replace(item, place=Place("held", other[item.place.where])) if item.place.relation == "held" else item
        for name, item in world.objects.items()
    }
    robots = {name: world.robots[other[name]] for name in world.robots}
    return replace(world, robots=FrozenMap(robots), objects=FrozenMap(objects))


def _judged(env_fn: EnvMaker, seed: int, choose: Choice, rounds: int) -> list[Turn]:
    """Play, and judge every world and its mirror image by the goal."""
    turns = []
    with opened(env_fn) as env:
        for turn in play(env, seed, choose, rounds=rounds):
            turns.append(turn)
            info = next(iter(turn.infos.values()))
            scene, goal = info["scene"], env.goal
            verdicts = {
                (goal.holds(scene, world), lost(goal, scene, world), progress(goal, scene, world))
                for world in (info["world"], swap_robots(info["world"]))
            }
            where = f"check_names, seed {seed}, round {turn.number}"
            expect(len(verdicts) == 1, f"{where}: the verdict differs when the robots' names are swapped: {verdicts}")
    return turns


def _check_replay(env_fn: EnvMaker, seed: int, script: list[Tokens], wait: int) -> None:
    with opened(env_fn) as env:
        first, second = env.possible_agents
        swapped = [{first: tokens[second], second: tokens[first]} for tokens in script]
        one = list(play(env, seed, scripted(script, otherwise=wait), rounds=len(script)))
        two = list(play(env, seed, scripted(swapped, otherwise=wait), rounds=len(script)))
    for turn, mirror in zip(one, two, strict=False):
        where = f"check_names, seed {seed}, round {turn.number}"
        for name, other in ((first, second), (second, first)):
            mine, theirs = _verdict(turn, name), _verdict(mirror, other)
            expect(mine == theirs, f"{where}: {name} gets {mine}, but as {other} {theirs}")
        world, image = turn.infos[first]["world"], mirror.infos[first]["world"]
        expect(swap_robots(world) == image, f"{where}: the world is not the mirror image when actions are swapped")
    expect(len(one) == len(two), f"check_names, seed {seed}: {len(one) - 1} rounds, swapped {len(two) - 1}")


def _verdict(turn: Turn, name: str) -> Mapping[str, Any]:
    outcome = turn.infos[name]["outcome"]
    return {
        "status": outcome.get("status"),
        "reason": outcome.get("reason"),
        "success": turn.infos[name]["success"],
        "reward": turn.rewards.get(name),
        "terminated": turn.terminations.get(name),
        "truncated": turn.truncations.get(name),
    }
