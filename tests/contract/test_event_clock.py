"""The event clock keeps its contract, and libraries' tests; environments that do not are found out."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import bad_clocks as bad
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test

import remac_env
from remac_env import testing
from remac_env.envs.ready_only import ReadyOnly
from remac_env.errors import ActionError, LifecycleError, OptionError, UnknownNameError
from remac_env.events.clock import IDLE, REFUSAL
from remac_env.testing import ContractError
from remac_env.thinking import Thought

TASK = "OpenMicrowavePnP"
A, B = "robot_0", "robot_1"


def make(task: str = TASK, **options: Any) -> Any:
    return remac_env.parallel_env(task, **({"backend": "symbolic", "clock": "events"} | options))


def send(env: Any, **commands: str) -> Any:
    """Step with commands; the robots that are named by none go on."""
    tokens = {robot: env.vocabulary.encode(commands.get(robot, "continue")) for robot in env.agents}
    _, rewards, _, _, infos = env.step(tokens)
    return infos, rewards


@pytest.mark.parametrize("robots", [1, 2])
@pytest.mark.parametrize("think", ["off", "fixed:2.5"])
def test_the_clock_keeps_its_contract(robots: int, think: str) -> None:
    kitchen = partial(make, robots=robots, think=think, reward="progress", starts="mixed")
    testing.check_events(kitchen, seeds=(0, 1), steps=60)
    testing.check_spaces(kitchen, seeds=(0,), rounds=40)
    testing.check_determinism(kitchen, seeds=(0, 1), rounds=40)
    testing.check_lifecycle(kitchen)


def test_other_checks_hold_as_with_rounds() -> None:
    testing.check_actions(make)
    testing.check_masks(make, limit=6)
    testing.check_changes(make)
    testing.check_names(make, seeds=(0,), rounds=12)


WRONG: list[tuple[Callable[[], Any], str]] = [
    (bad.AsksTheBusy, "is asked, and nothing says"),
    (bad.MasksNothing, "the mask is empty"),
    (bad.ForgetsContinue, "it is busy, and its mask"),
    (bad.OffersContinue, "it is ready, and its mask"),
    (bad.StandsStill, "time stands still"),
    (bad.TellsTwice, "is told of .* and is busy"),
    (bad.TellsTheLastAgain, "told of .* decided at"),
    (bad.LosesAnOutcome, "nothing says that"),
    (bad.CountsFromTheStart, "tau, return and decision"),
    (bad.PaysTwice, "tau, return and decision"),
    (bad.CountsSteps, "tau, return and decision"),
    (bad.RunningMayBeNone, r"info\['running'\] is a NoneType"),
]


@pytest.mark.parametrize(("environment", "message"), WRONG, ids=[entry[0].__name__ for entry in WRONG])  # type: ignore[attr-defined]
def test_a_wrong_clock_is_found_out(environment: Any, message: str) -> None:
    with pytest.raises(ContractError, match=message):
        testing.check_events(environment, seeds=(0, 1))


def test_the_base_of_the_wrong_clocks_is_right() -> None:
    testing.check_events(bad.Timed, seeds=(0, 1))


@pytest.mark.parametrize("robots", [1, 2])
@pytest.mark.parametrize("obs_format", ["dict", "flat"])
def test_libraries_accept_it(robots: int, obs_format: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(make(robots=robots, obs_format=obs_format), num_cycles=150)
        parallel_seed_test(lambda: make(robots=robots), num_cycles=30)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # PettingZoo warns of Dict observations, which its own mask convention asks for
        aec = remac_env.env(TASK, robots=robots, backend="symbolic", clock="events", think="fixed:1", max_seconds=120)
        api_test(aec, num_cycles=150)
        env = gymnasium.make(f"RemacKitchen-{TASK}-v0", robots=robots, backend="symbolic", clock="events")
        check_env(env.unwrapped, skip_render_check=True)


def test_tokens_of_the_rounds_do_not_move_and_continue_comes_last() -> None:
    rounds, events = make(clock="rounds"), make()
    assert [events.vocabulary.decode(t) for t in range(len(rounds.vocabulary))] == [
        rounds.vocabulary.decode(t) for t in range(len(rounds.vocabulary))
    ]
    assert events.vocabulary.decode(len(rounds.vocabulary)) == "continue"
    assert len(events.vocabulary) == len(rounds.vocabulary) + 1
    with pytest.raises(UnknownNameError):
        rounds.vocabulary.encode("continue")
    seen, infos = events.reset(seed=0)
    before, told = rounds.reset(seed=0)
    size = len(before[A]["observation"])
    assert np.array_equal(seen[A]["observation"][:size], before[A]["observation"])
    assert "continue" not in infos[A]["commands"] and infos[A]["commands"] == told[A]["commands"]
    assert "ready" not in told[A]


def test_robots_do_not_wait_for_each_other() -> None:
    env = make()
    env.reset(seed=1)
    infos, _ = send(env, robot_0="navigate to microwave", robot_1="navigate to stove")
    assert infos[A]["ready"] and infos[B]["ready"] and infos[A]["seconds"] == 6.0
    infos, _ = send(env, robot_0="open microwave door", robot_1="navigate to vegetable")
    assert (infos[A]["ready"], infos[B]["ready"], infos[B]["seconds"]) == (False, True, 12.0)
    assert (infos[A]["running"], infos[A]["elapsed"], infos[A]["outcome"]) == ("open microwave door", 6.0, {})
    assert infos[B]["outcome"]["status"] == "success" and infos[B]["tau"] == 6.0
    infos, _ = send(env, robot_1="pick up vegetable")
    assert (infos[A]["ready"], infos[B]["running"], infos[A]["seconds"]) == (True, "pick up vegetable", 15.0)
    assert infos[A]["outcome"]["ended"] == 15.0 and infos[A]["outcome"]["seconds"] == 9.0
    assert infos[A]["decision"] == 2 and infos[B]["decision"] == 3
    assert "robot_1: pick up vegetable, for 3 s so far." in infos[A]["text"]
    # What a busy robot is told is not heard, whatever it is.
    infos, _ = send(env, robot_0="wait", robot_1="open microwave door")
    assert infos[B]["outcome"]["status"] == "success" and infos[B]["seconds"] == 20.0
    assert infos[A]["outcome"] == {
        "status": "success", "reason": "", "detail": "", "seconds": 5.0, "began": 15.0, "ended": 20.0,
    }  # fmt: skip


def test_time_goes_on_where_all_wait_and_where_nothing_is_done() -> None:
    env = make()
    env.reset(seed=1)
    infos, _ = send(env, robot_0="wait", robot_1="wait")
    assert infos[A]["seconds"] == IDLE and infos[A]["ready"] and infos[B]["ready"]
    infos, _ = send(env, robot_0="pick up vegetable", robot_1="wait")
    assert infos[A]["outcome"]["reason"] == "not_at_station" and infos[A]["seconds"] == IDLE + REFUSAL
    infos, _ = send(env, robot_0="continue", robot_1="navigate to stove")
    assert infos[A]["outcome"]["reason"] == "invalid" and not infos[B]["ready"]
    infos, _ = send(env, robot_0="done")
    assert infos[B]["ready"] and infos[A]["ready"]
    infos, _ = send(env, robot_0="wait", robot_1="done")
    assert infos[A]["end"] == "done" and infos[A]["seconds"] == 12.0, "once all have finished no time goes by"


def test_it_ends_with_the_goal_or_when_time_is_up() -> None:
    env = make(max_seconds=14.0)
    env.reset(seed=1)
    send(env, robot_0="navigate to microwave", robot_1="navigate to vegetable")
    tokens = {A: env.vocabulary.encode("open microwave door"), B: env.vocabulary.encode("pick up vegetable")}
    _, _, terminations, truncations, infos = env.step(tokens)
    assert infos[B]["outcome"]["ended"] == 14.0 and infos[A]["running"] == "open microwave door"
    assert all(truncations.values()) and not any(terminations.values()) and env.agents == []
    with pytest.raises(LifecycleError):
        env.step(tokens)
    env = make()
    env.reset(seed=1)
    send(env, robot_0="navigate to microwave", robot_1="navigate to vegetable")
    send(env, robot_0="open microwave door", robot_1="pick up vegetable")
    send(env)
    send(env, robot_0="navigate aside", robot_1="wait")
    send(env, robot_0="wait", robot_1="navigate to microwave")
    infos, rewards = send(env, robot_0="wait", robot_1="place to microwave")
    assert infos[A]["success"] and rewards == {A: 1.0, B: 1.0} and infos[B]["return"] == 1.0
    assert infos[A]["seconds"] == 36.0


def test_thinking_takes_its_time_while_others_go_on() -> None:
    env = make(think="tokens:2")
    env.reset(seed=1)
    env.note_thought(A, Thought(tokens=500))
    env.note_thought(B, Thought(tokens=3000, seconds=99.0))
    infos, _ = send(env, robot_0="navigate to microwave", robot_1="navigate to stove")
    assert (infos[A]["running"], infos[B]["running"]) == ("navigate to microwave", "thinking")
    assert infos[A]["seconds"] == 1.0 and not infos[A]["ready"]
    with pytest.raises(UnknownNameError, match="robot_0.*none"):
        env.note_thought(A, Thought(tokens=1))
    infos, _ = send(env)
    assert (infos[B]["running"], infos[B]["seconds"]) == ("navigate to stove", 6.0)
    infos, _ = send(env)
    assert infos[A]["outcome"]["began"] == 1.0 and infos[A]["seconds"] == 7.0
    infos, _ = send(env, robot_0="wait")
    assert infos[B]["outcome"]["ended"] == 12.0
    assert infos[B]["tau"] == 12.0 and infos[A]["ready"], "a wait without a thought takes effect at once"


@pytest.mark.parametrize("value", ["on", "fixed", "fixed:-1", "tokens:nan", "off:1", 3, "fixed:x"])
def test_no_other_thinking_is_taken(value: Any) -> None:
    with pytest.raises(OptionError, match=r"think .*valid: off, fixed:S"):
        make(think=value)


def test_thinking_and_rounds_do_not_go_together() -> None:
    with pytest.raises(OptionError, match="clock='events'"):
        make(clock="rounds", think="fixed:1")
    with pytest.raises(OptionError, match="tokens -1"):
        Thought(tokens=-1)


def test_nobody_is_asked_who_is_busy_in_the_cycle() -> None:
    env = remac_env.env(TASK, backend="symbolic", clock="events", max_seconds=200.0)
    env.reset(seed=2)
    for number, robot in enumerate((A, B)):
        env.action_space(robot).seed(number)  # or, once in a while, chance ends the episode while they still take turns
    asked, clock = [], 0.0
    for robot in env.agent_iter(200):
        seen, reward, terminated, truncated, info = env.last()
        if terminated or truncated:
            env.step(None)
            continue
        assert info["ready"] and seen["action_mask"][-1] == 0 and reward == info["return"]
        assert info["seconds"] >= clock
        clock = info["seconds"]
        asked.append(robot)
        env.step(env.action_space(robot).sample(seen["action_mask"]))
    assert set(asked) == {A, B} and asked != [A, B] * (len(asked) // 2), "they do not take turns"
    with pytest.raises(LifecycleError):
        env.last()


def test_busy_robots_are_dropped() -> None:
    env = ReadyOnly(make())
    seen, infos = env.reset(seed=1)
    assert set(seen) == {A, B}
    token = env.kitchen.vocabulary.encode
    seen, rewards, *_ = env.step({A: token("navigate to microwave"), B: token("navigate to stove")})
    assert set(seen) == set(rewards) == {A, B}
    seen, *_ = env.step({A: token("open microwave door"), B: token("navigate to vegetable")})
    assert set(seen) == {B}
    with pytest.raises(ActionError, match="robot_1"):
        env.step({A: token("wait"), B: token("wait")})
    seen, _, _, _, infos = env.step({B: token("pick up vegetable")})
    assert set(seen) == set(infos) == {A}


@pytest.mark.long
def test_a_hundred_thousand_random_calls() -> None:
    env = make(max_seconds=3000.0, think="fixed:0.7")
    chance, steps, episodes = np.random.default_rng(5), 0, 0
    while steps < 100_000:
        env.reset(seed=episodes)
        episodes += 1
        while env.agents:
            env.step({robot: int(chance.integers(-2, len(env.vocabulary) + 2)) for robot in env.agents})
            steps += 1
    assert episodes > 10


@pytest.mark.long
def test_physics_keeps_the_clock_s_contract() -> None:
    def in_physics() -> Any:
        return make(backend="physics", layout="one_wall_large", style="modern_1", think="fixed:0.5", max_seconds=60.0)

    testing.check_events(in_physics, seeds=(1,), steps=12)
    testing.check_determinism(in_physics, seeds=(1,), rounds=8)
