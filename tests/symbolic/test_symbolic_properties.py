"""Random rounds keep a world whole, whatever the commands (hypothesis)."""

from __future__ import annotations

import copy
import operator
import pickle
from typing import Any

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings
from table_kitchen import A, B, TableKitchen

import remac_env
from remac_env.rules.outcomes import REASONS
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import Subtask
from remac_env.state import FrozenMap, WorldState
from remac_env.testing import check_world, swap_robots
from remac_env.vocabulary import built_in

TASKS = ("OpenCabinetPnP", "OpenMicrowavePnP", "DefrostInBowl", "HeatOnStove")
KITCHENS = {
    (task, starts): remac_env.parallel_env(task, backend="symbolic", starts=starts)
    for task in TASKS
    for starts in ("paper", "mixed")
}

tasks = st.sampled_from(sorted(KITCHENS))
seeds = st.integers(0, 10_000)
# Two of three draws fall upon commands that move something, so that episodes get somewhere.
draws = st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 10**6)), min_size=1, max_size=25)


def legal(env: Any) -> list[Subtask]:
    return [env.vocabulary.parse(text) for text in env.vocabulary.commands(env.start.scene)]


def pick(env: Any, world: WorldState, robot: str, draw: int) -> Subtask:
    commands = legal(env)
    scene = env.start.scene
    workable = [c for c in commands if all(r.condition.holds(scene, world) for r in c.requirements(robot))]
    pool = workable if draw % 3 else commands
    return pool[draw // 3 % len(pool)]


@given(tasks, seeds, draws)
@settings(max_examples=60)
def test_random_rounds_keep_the_world_whole(key: tuple[str, str], seed: int, rounds: list[tuple[int, int]]) -> None:
    env = KITCHENS[key]
    env.reset(seed=seed)
    scene, world = env.start.scene, env.world
    check_world(scene, world)
    for number, joint in enumerate(rounds):
        subtasks = {robot: pick(env, world, robot, draw) for robot, draw in zip(scene.robots, joint, strict=True)}
        after, outcomes = transition(scene, world, subtasks)
        check_world(scene, after, where=f"round {number}, {subtasks}")
        for robot, outcome in outcomes.items():
            assert outcome.success == (outcome.reason is None)
            assert outcome.success or outcome.reason in REASONS
            if outcome.reason in ("not_at_station", "station_occupied", "hands_full", "hands_empty", "already_done"):
                assert after.robots[robot] == world.robots[robot]
        if not any(outcome.success for outcome in outcomes.values()):
            dropped = [robot for robot, outcome in outcomes.items() if outcome.reason == "dropped"]
            assert (after == world) == (not dropped)
        mirrored, told = transition(scene, swap_robots(world), {A: subtasks[B], B: subtasks[A]})
        assert mirrored == swap_robots(after)
        assert (told[A].reason, told[B].reason) == (outcomes[B].reason, outcomes[A].reason)
        world = after


@given(seeds, draws)
@settings(max_examples=40)
def test_after_success_holds_what_the_skill_achieves(seed: int, rounds: list[tuple[int, int]]) -> None:
    """One robot at a time. `turn off` is the exception: several burners may be lit, and it turns one knob."""
    env = KITCHENS["HeatOnStove", "mixed"]
    env.reset(seed=seed)
    scene, world = env.start.scene, env.world
    for first, second in rounds:
        robot = (A, B)[second % 2]
        subtask, held = pick(env, world, robot, first), world.robots[robot].holding
        world, outcomes = transition(scene, world, {robot: subtask})
        achieved = [c.holds(scene, world) for c in subtask.achieves(robot, held)]
        if outcomes[robot].success and subtask.skill != "turn off":
            assert all(achieved), (subtask, world)


@given(st.permutations(range(6)), st.permutations(range(2)))
@settings(max_examples=25)
def test_equal_worlds_are_equal_and_hash_equal_in_any_order(things: list[int], robots: list[int]) -> None:
    world = TableKitchen().world

    def shuffled(mapping: Any, order: list[int]) -> FrozenMap:
        pairs = list(mapping.items())
        return FrozenMap(dict(pairs[index] for index in order))

    other = WorldState(shuffled(world.robots, robots), shuffled(world.objects, things), world.fixtures)
    assert other == world and hash(other) == hash(world)
    assert pickle.loads(pickle.dumps(other)) == world
    moved = world.with_robot(A, station="sink")
    assert moved != world and moved.with_robot(A, station="aside") == world
    assert len({world, other, moved}) == 2


@given(st.text(max_size=40))
@settings(max_examples=200)
def test_parsing_never_raises_and_only_knows_commands(text: str) -> None:
    found = built_in().parse(text)
    assert found is None or found.text == built_in().decode(built_in().encode(text))


def test_a_frozen_map_is_equal_to_its_like_alone_and_does_not_change() -> None:
    facts = FrozenMap({"a": 1, "b": 2})
    alike = FrozenMap({"b": 2, "a": 1})
    assert facts == alike and hash(facts) == hash(alike) and not operator.ne(facts, alike)
    plain = dict(facts)
    assert operator.ne(facts, plain) and operator.ne(plain, facts) and not operator.eq(plain, facts)
    assert facts.with_("a", 3) == FrozenMap({"a": 3, "b": 2}) and facts["a"] == 1
    assert pickle.loads(pickle.dumps(facts)) == facts == copy.deepcopy(facts)
    for change in (
        lambda: facts.__setitem__("a", 3),
        lambda: facts.__delitem__("a"),
        lambda: facts.__ior__({"a": 3}),
        lambda: facts.update(a=3),
        lambda: facts.pop("a"),
        facts.popitem,
        lambda: facts.setdefault("c", 3),
        facts.clear,
    ):
        with pytest.raises(TypeError, match="cannot change"):
            change()
    assert facts == alike
