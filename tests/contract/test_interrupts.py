"""Robots at work are told to stop: what the two backends and the clock make of it, and what must not come of it."""

from __future__ import annotations

from functools import partial
from typing import Any

import bad_clocks as bad
import numpy as np
import pytest
from pettingzoo.test import api_test, parallel_api_test

import remac_env
from remac_env import testing
from remac_env.errors import LifecycleError, OptionError, UnknownNameError
from remac_env.events.clock import REFUSAL
from remac_env.testing import ContractError
from remac_env.thinking import Thought

TASK = "OpenMicrowavePnP"
A, B = "robot_0", "robot_1"


def make(task: str = TASK, **options: Any) -> Any:
    return remac_env.parallel_env(task, **({"backend": "symbolic", "clock": "events", "interrupts": True} | options))


def send(env: Any, **commands: str) -> Any:
    tokens = {robot: env.vocabulary.encode(commands.get(robot, "continue")) for robot in env.agents}
    return env.step(tokens)[4]


def at_the_microwave(**options: Any) -> Any:
    """robot_0 has set out to open the microwave, robot_1 stands at the stove; 7 s have gone by."""
    env = make(**options)
    env.reset(seed=1)
    send(env, robot_0="navigate to microwave", robot_1="navigate to stove")
    send(env, robot_0="open microwave door", robot_1="open cabinet door")
    return env


@pytest.mark.parametrize("think", ["off", "fixed:2.5"])
def test_stops_keep_the_contracts(think: str) -> None:
    for task in (TASK, "WashPnPHeat"):
        kitchen = partial(make, task, think=think, starts="mixed")
        testing.check_interrupts(kitchen, seeds=(0, 1), steps=70)
        testing.check_events(kitchen, seeds=(0,), steps=50)
    testing.check_determinism(kitchen, seeds=(0,), rounds=30)


WRONG = [
    (bad.StopTeleports, "when it has stopped"),
    (bad.StopLetsFall, "when it has stopped"),
    (bad.StopLeavesClaims, "after a stop the same is refused"),
    (bad.StopsByItself, "nobody told it to stop"),
    (bad.StopIsDeaf, "told to stop .* s ago"),
    (bad.Timed, "no such word|unknown|valid"),
]


@pytest.mark.parametrize(("environment", "message"), WRONG, ids=[entry[0].__name__ for entry in WRONG])
def test_a_wrong_stop_is_found_out(environment: Any, message: str) -> None:
    with pytest.raises((ContractError, UnknownNameError), match=message):
        testing.check_interrupts(environment, seeds=(0, 1, 2), steps=120)


def test_the_base_of_the_wrong_ones_is_right() -> None:
    testing.check_interrupts(bad.Stoppable, seeds=(0, 1, 2), steps=120)


def test_a_hand_turns_back_in_the_first_half_and_goes_through_in_the_second() -> None:
    env = at_the_microwave()
    before = env.world
    infos = send(env, robot_0="stop")
    assert infos[A]["seconds"] == 8.0 and infos[A]["outcome"]["reason"] == "interrupted"
    assert (infos[A]["outcome"]["began"], infos[A]["outcome"]["seconds"]) == (6.0, 2.0)
    assert env.world == before and infos[A]["ready"]
    infos = send(env, robot_0="open microwave door", robot_1="navigate to counter")
    while not infos[A]["outcome"]:
        infos = send(env, robot_0="stop" if infos[A]["elapsed"] > 4.5 else "continue", robot_1="wait")
    assert infos[A]["outcome"]["status"] == "success" and env.world.fixtures["microwave"].door == "open"


def test_a_drive_goes_through() -> None:
    env = make()
    env.reset(seed=1)
    send(env, robot_0="navigate to microwave", robot_1="open cabinet door")
    infos = send(env, robot_0="stop", robot_1="wait")
    assert infos[A]["outcome"]["status"] == "success" and infos[A]["seconds"] == 6.0


def test_a_thought_is_dropped_in_a_second() -> None:
    env = make(think="tokens:10")
    env.reset(seed=1)
    env.note_thought(A, Thought(tokens=800))
    env.note_thought(B, Thought(tokens=100))
    infos = send(env, robot_0="navigate to microwave", robot_1="open cabinet door")
    assert infos[A]["running"] == "thinking" and infos[A]["seconds"] == 1.0
    infos = send(env, robot_0="stop")
    told = next(span for span in env.timeline if span.who == A and span.kind == "thought")
    assert infos[A]["outcome"]["reason"] == "interrupted" and infos[A]["seconds"] == told.ended + REFUSAL == 2.0
    assert told.reason == "interrupted" and env.world.robots[A].station == "aside"


def test_tokens_do_not_move_and_stop_comes_last() -> None:
    env, plain = make(), make(interrupts=False)
    assert env.vocabulary.encode("stop") == len(plain.vocabulary) == plain.vocabulary.encode("continue") + 1
    _, infos = env.reset(seed=0)
    _, told = plain.reset(seed=0)
    assert infos[A]["stop"] == env.vocabulary.encode("stop") and "stop" not in told[A]
    assert infos[A]["commands"] == told[A]["commands"] and not env.action_mask(A)[infos[A]["stop"]]
    env = at_the_microwave()
    assert {env.vocabulary.decode(int(t)) for t in np.flatnonzero(env.action_mask(A))} == {"continue", "stop"}


def test_libraries_accept_it_and_aec_stops_from_outside() -> None:
    parallel_api_test(make(), num_cycles=100)
    aec = remac_env.env(TASK, backend="symbolic", clock="events", interrupts=True, max_seconds=120)
    api_test(aec, num_cycles=100)
    aec.reset(seed=1)
    for command in ("navigate to microwave", "navigate to stove", "open microwave door", "open cabinet door"):
        aec.step(aec.vocabulary.encode(command))
    assert aec.agent_selection == B
    with pytest.raises(UnknownNameError, match="'robot_1' is not busy; valid: robot_0"):
        aec.stop(B)
    aec.stop(A)
    aec.step(aec.vocabulary.encode("wait"))
    assert aec.agent_selection == A and aec.infos[A]["outcome"]["reason"] == "interrupted"
    other = remac_env.env(TASK, backend="symbolic", clock="events")
    other.reset(seed=1)
    with pytest.raises(LifecycleError, match="interrupts=True"):
        other.stop(A)


def test_it_belongs_to_the_event_clock() -> None:
    with pytest.raises(OptionError, match="interrupts=True is for clock='events'"):
        make(clock="rounds")
    with pytest.raises(OptionError, match="valid: True or False"):
        make(interrupts="no")


@pytest.mark.long
def test_physics_comes_home_and_can_begin_again() -> None:
    env = make(backend="physics", robots=2)
    env.reset(seed=1)
    infos = send(env, robot_0="navigate to microwave", robot_1="navigate to stove")
    while not infos[A]["ready"]:
        infos = send(env, robot_1="wait")
    arm = env._backend._timeline.pilot(A).here.robot
    home = arm.measured
    infos = send(env, robot_0="open microwave door", robot_1="open cabinet door")
    infos = send(env, robot_0="stop", robot_1="wait")
    while not infos[A]["outcome"]:
        infos = send(env, robot_1="wait")
    assert infos[A]["outcome"]["reason"] == "interrupted" and infos[A]["outcome"]["seconds"] < 12.0
    assert env.world.fixtures["microwave"].door != "open" and env.world.robots[A].station == "microwave"
    assert np.abs(arm.measured - home).max() < 0.05
    infos = send(env, robot_0="open microwave door", robot_1="wait")
    while not infos[A]["outcome"]:
        infos = send(env, robot_1="wait")
    assert infos[A]["outcome"]["status"] == "success" and env.world.fixtures["microwave"].door == "open"


@pytest.mark.long
def test_stops_keep_the_contract_in_physics() -> None:
    testing.check_interrupts(partial(make, backend="physics", robots=2), seeds=(1,), steps=25)
