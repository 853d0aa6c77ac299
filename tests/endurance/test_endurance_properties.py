"""Drawn cells, seeds and commands, in both backends: what must hold after every round holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import endurance_properties as properties
import hypothesis.strategies as st
import numpy as np
import pytest
from endurance_properties import PROPERTIES, Joint, Seen, look
from hypothesis import Phase, given, settings

import remac_env
from remac_env.kitchen import layout, style
from remac_env.state import FrozenMap, ObjectState, Place, RobotState
from remac_env.testing.play import ContractError

NONSENSE = (-1, -(2**70), 10**6, 2**63, 10**40)
"""Whole numbers that are no tokens."""


@dataclass(frozen=True)
class Cell:
    """Everything that an episode is drawn from. Seeds stay below 100,000."""

    task: str
    style: str | None
    layout: str | None
    starts: str
    robots: int
    seed: int
    rate: float


cells = st.builds(
    Cell,
    task=st.sampled_from(remac_env.tasks()),
    style=st.none() | st.sampled_from(style.names()),
    layout=st.none() | st.sampled_from(layout.names()),
    starts=st.sampled_from(["paper", "mixed"]),
    robots=st.sampled_from([1, 2]),
    seed=st.integers(0, 99_999),
    rate=st.sampled_from([0.0, 0.0, 0.3]),
)
draws = st.tuples(st.integers(0, 10**6), st.integers(0, 10**6))
"""One draw for each robot, see `token`."""


def commands(least: int, most: int) -> st.SearchStrategy[list[tuple[int, int]]]:
    """A round's draws for each of so many rounds."""
    return st.lists(draws, min_size=least, max_size=most)


@cache
def made(backend: str, task: str, starts: str, robots: int, rate: float) -> Any:
    """An environment; `rate`: how often subtasks slip in the symbolic backend, or a tenth of the noise in physics."""
    noise = {"failure_rate": rate} if backend == "symbolic" else {"perception_noise": rate / 10}
    return remac_env.parallel_env(task, backend=backend, starts=starts, robots=robots, **noise)


def token(env: Any, robot: str, mask: Any, draw: int) -> int:
    """Half of the draws are commands that can be carried out, two of eight any, one is masked, one is nonsense."""
    kind, rest = draw % 8, draw // 8
    if kind == 7:
        return NONSENSE[rest % len(NONSENSE)]
    if kind == 6:
        masked = np.flatnonzero(mask == 0)
        return int(masked[rest % len(masked)])
    legal = [int(one) for one in np.flatnonzero(mask) if env.vocabulary.decode(int(one)) != "done"]
    if kind < 4:
        needed = {one: env.vocabulary.subtask(one).requirements(robot) for one in legal if one}
        scene, world = env.start.scene, env.world
        legal = [one for one, all_of in needed.items() if all(r.condition.holds(scene, world) for r in all_of)] or legal
    return legal[rest % len(legal)]


def episode(backend: str, cell: Cell, rounds: list[tuple[int, int]]) -> list[str]:
    """Play the draws and look at every property; the reasons and successes met."""
    env = made(backend, cell.task, cell.starts, cell.robots, cell.rate)
    options = {key: name for key, name in (("style", cell.style), ("layout", cell.layout)) if name is not None}
    env.reset(seed=cell.seed, options=options)
    digest, first = env.start.digest, env.world
    observations, infos = env.reset(seed=cell.seed, options=options)
    assert (env.start.digest, env.world, hash(env.world)) == (digest, first, hash(first))
    met, world = [], env.world
    for number, joint in enumerate([None, *rounds]):
        if joint is not None:
            if not env.agents:
                break
            drawn = dict(zip(env.agents, joint, strict=False))
            tokens = {r: token(env, r, observations[r]["action_mask"], draw) for r, draw in drawn.items()}
            observations, _, _, _, infos = env.step(tokens)
            met += [str(info["outcome"]["reason"]) for info in infos.values()]
        seen = look(env, world, observations, infos)
        for holds in PROPERTIES:
            try:
                holds(seen)
            except ContractError as error:
                raise ContractError(f"{holds.__name__}, {cell}, round {number}: {error}") from error
        world = env.world
    return met


# Where a physical episode fails, trying smaller ones would take minutes.
few = settings(derandomize=True, deadline=None, phases=[Phase.generate])


@settings(few, max_examples=60)
@given(cells, commands(1, 25))
def test_properties_hold_in_the_symbolic_backend(cell: Cell, rounds: list[tuple[int, int]]) -> None:
    episode("symbolic", cell, rounds)


@settings(few, max_examples=5)
@given(cells, commands(6, 8))
def test_properties_hold_in_physics(cell: Cell, rounds: list[tuple[int, int]]) -> None:
    episode("physics", cell, rounds)


@pytest.mark.long
@settings(few, max_examples=2000)
@given(cells, commands(1, 40))
def test_properties_hold_in_many_symbolic_episodes(cell: Cell, rounds: list[tuple[int, int]]) -> None:
    episode("symbolic", cell, rounds)


@pytest.mark.long
@settings(few, max_examples=60)
@given(cells, commands(6, 14))
def test_properties_hold_in_many_physical_episodes(cell: Cell, rounds: list[tuple[int, int]]) -> None:
    episode("physics", cell, rounds)


def test_the_draws_reach_what_is_to_be_tested() -> None:
    """Successes, refusals and lost rounds are all among what the draws lead to."""
    cell = Cell("HeatOnStove", None, None, "mixed", 2, 7, 0.0)
    met = episode("symbolic", cell, [(8 * k + k % 8, 8 * (3 * k + 1) + (k + 3) % 8) for k in range(16)])
    assert met.count("") >= 6 and "invalid" in met and len(set(met)) >= 4


# -- each property fails on a fault that is made for it ---------------------------------------------------------------


def seen_in(backend: str) -> Seen:
    """A round as it should be."""
    env = made(backend, "HeatOnStove", "paper", 2, 0.0)
    env.reset(seed=3)
    before = env.world
    observations, _, _, _, infos = env.step(dict.fromkeys(env.agents, 0))
    return look(env, before, observations, infos)


def _thing_gone(seen: Seen) -> Seen:
    objects = dict(list(seen.after.objects.items())[1:])
    return replace(seen, after=replace(seen.after, objects=FrozenMap(objects)))


def _thing_in_two_places(seen: Seen) -> Seen:
    """A robot is said to hold what stands on the counter."""
    return replace(seen, after=seen.after.with_robot("robot_1", holding=next(iter(seen.after.objects))))


def _held_by_nobody(seen: Seen) -> Seen:
    return replace(seen, after=seen.after.with_object(next(iter(seen.after.objects)), place=Place("held", "robot_0")))


def _forgets_to_be_washed(seen: Seen) -> Seen:
    name = next(iter(seen.before.objects))
    return replace(seen, before=seen.before.with_object(name, marks=frozenset({"washed"})))


def _joint(seen: Seen, **changes: Any) -> Seen:
    doors = [joint for joint in seen.joints if "door" in joint.name]
    return replace(seen, joints=tuple(replace(joint, **changes) for joint in doors))


def _told(seen: Seen, key: str, change: Callable[[Any], Any]) -> Seen:
    told = {robot: {**parts, key: change(parts[key])} for robot, parts in seen.observations.items()}
    return replace(seen, observations=told)


def _outcome(seen: Seen, **changes: Any) -> Seen:
    told = {r: {**info, "outcome": {**info["outcome"], **changes}} for r, info in seen.infos.items()}
    return replace(seen, infos=told)


def _nan(values: Any) -> Any:
    changed = np.array(values, np.float32)
    changed[-1] = np.nan
    return changed


FAULTS: Mapping[str, tuple[Callable[[Seen], None], Callable[[Seen], Seen], str]] = {
    "a thing is gone": (properties.objects_are_conserved, _thing_gone, "objects came or went"),
    "a thing twice": (properties.objects_are_conserved, _thing_in_two_places, "robot_1 holds"),
    "held by nobody": (properties.objects_are_conserved, _held_by_nobody, "robot_0 holds"),
    "not washed any more": (properties.marks_stay, _forgets_to_be_washed, "lost marks"),
    "a door bent outwards": (
        properties.doors_and_switches_keep_their_limits, lambda s: _joint(s, position=99.0), "is at 99.000",
    ),
    "a door bent inwards": (
        properties.doors_and_switches_keep_their_limits, lambda s: _joint(s, position=-0.1), "is at -0.100",
    ),
    "an open door called closed": (
        properties.doors_and_switches_keep_their_limits, lambda s: _joint(s, position=1.0), "is called closed",
    ),
    "a velocity is NaN": (
        properties.numbers_are_finite, lambda s: replace(s, numbers={**s.numbers, "qvel": np.array([0, np.inf])}),
        "qvel is not finite",
    ),
    "an observation is NaN": (
        properties.numbers_are_finite, lambda s: _told(s, "observation", _nan), "observation of robot_0",
    ),
    "a warning": (
        properties.the_simulator_does_not_warn, lambda s: replace(s, warnings={**s.warnings, "bad": 1}), "bad",
    ),
    "facts of two": (
        properties.observations_lie_in_their_spaces, lambda s: _told(s, "observation", lambda v: v * 2), "outside",
    ),
    "a mask of floats": (
        properties.observations_lie_in_their_spaces, lambda s: _told(s, "action_mask", _nan), "outside its space",
    ),
    "nobody is told": (
        properties.observations_lie_in_their_spaces, lambda s: replace(s, observations={}), "nobody",
    ),
    "bad luck": (
        properties.outcomes_are_from_the_list, lambda s: _outcome(s, status="failure", reason="bad luck"), "bad luck",
    ),
    "success for a reason": (
        properties.outcomes_are_from_the_list, lambda s: _outcome(s, reason="timeout"), "timeout",
    ),
    "no outcome": (
        properties.outcomes_are_from_the_list,
        lambda s: replace(s, infos={r: {**info, "outcome": {}} for r, info in s.infos.items()}), "no outcome",
    ),
    "refused and gone": (
        properties.refused_robots_stay_as_they_are,
        lambda s: _outcome(replace(s, after=s.after.with_robot("robot_0", station="sink")), reason="hands_full"),
        "was refused",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def sound() -> Seen:
    """A round of physics in which nothing is wrong."""
    return seen_in("physics")


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found(name: str, sound: Seen) -> None:
    holds, planted, words = FAULTS[name]
    holds(sound)
    with pytest.raises(ContractError, match=words):
        holds(planted(sound))


def test_every_property_has_a_fault_and_something_to_look_at(sound: Seen) -> None:
    assert {holds for holds, _, _ in FAULTS.values()} == set(PROPERTIES)
    assert sum("door" in joint.name for joint in sound.joints) >= 2
    assert len(sound.numbers["qpos"]) > 20 and len(sound.warnings) >= 5
    assert isinstance(sound.joints[0], Joint) and seen_in("symbolic").joints == ()


def test_equal_worlds_hash_equal_after_different_histories() -> None:
    """Two robots go away and come back: the world is the one that it was."""
    env = made("symbolic", "OpenCabinetPnP", "paper", 2, 0.0)
    env.reset(seed=11)
    first = env.world
    for there in ("navigate to sink", "navigate aside"):
        env.step({"robot_0": env.vocabulary.encode(there), "robot_1": 0})
    assert env.world == first and hash(env.world) == hash(first) and len({env.world, first}) == 1
    moved = first.with_robot("robot_0", station="sink")
    assert moved != first and len({moved, first}) == 2
    assert RobotState() != RobotState("sink") and ObjectState(Place("floor")) != ObjectState(Place("slot", "counter.0"))
