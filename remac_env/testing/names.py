"""check_names: no robot is number zero."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from remac_env.oracle import most_states, solve
from remac_env.seeding import generator
from remac_env.state import FrozenMap, Place, WorldState
from remac_env.tasks.goals import lost, progress
from remac_env.testing.play import Choice, EnvMaker, Tokens, Turn, expect, mask_of, opened, play, random_legal, scripted

FEW = 100
"""A shortest plan is searched for in so many times fewer states than usual; then any plan will do, for quickness."""


def check_names(env_fn: EnvMaker, *, seeds: Iterable[int] = (0, 1), rounds: int = 30, replay: bool = True) -> None:
    """Swap the robots' actions: the robots are swapped in the result, and the verdict is the same.

    Of three or more robots each is given the actions of the one before it, and the first those of the last.

    Plays random legal episodes, a plan that reaches the goal, and rounds in which both robots are given the same token.

    Args:
        env_fn: makes a new environment.
        seeds: of the episodes; rounds: of a random one at most.
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
            plan = solve(env.start.scene, env.world, env.goal, max_states=most_states(env.start.scene) // FEW)
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
    """The world with the robots' names exchanged: each has that of the next one, the last that of the first."""
    other = _following(world.robots)
    objects = {
        name: replace(item, place=Place("held", other[item.place.where])) if item.place.relation == "held" else item
        for name, item in world.objects.items()
    }
    robots = {other[name]: state for name, state in world.robots.items()}
    return replace(world, robots=FrozenMap(robots), objects=FrozenMap(objects))


def _following(robots: Iterable[str]) -> dict[str, str]:
    """Robot -> the next one, by name; the last -> the first."""
    names = sorted(robots)
    return dict(zip(names, [*names[1:], *names[:1]], strict=True))


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
        following = _following(env.possible_agents)
        swapped = [{following[name]: token for name, token in tokens.items()} for tokens in script]
        one = list(play(env, seed, scripted(script, otherwise=wait), rounds=len(script)))
        two = list(play(env, seed, scripted(swapped, otherwise=wait), rounds=len(script)))
    for turn, mirror in zip(one, two, strict=False):
        where = f"check_names, seed {seed}, round {turn.number}"
        for name, other in following.items():
            mine, theirs = _verdict(turn, name), _verdict(mirror, other)
            expect(mine == theirs, f"{where}: {name} gets {mine}, but as {other} {theirs}")
        world, image = (next(iter(each.infos.values()))["world"] for each in (turn, mirror))
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
