"""The learned controller: its files, what they are held against, and how its subtasks end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from learned_kit import CHUNK, COMMANDED, SKILL, network, weights

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.learned.aim import feels
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.library import file_name, learned_skills
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.weights import (
    SEVERAL,
    About,
    Weights,
    bag,
    read_weights,
    save_weights,
)
from remac_env.errors import OptionError
from remac_env.lowlevel.starts import ROBOT, get_ready
from remac_env.rules.outcomes import Outcome
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask


def test_what_is_saved_says_the_same_when_it_is_read(tmp_path: Path) -> None:
    save_weights(tmp_path / "TurnOn.npz", weights())
    again = read_weights(tmp_path / "TurnOn.npz")
    assert again.about.skill == SKILL and len(again.sha256) == 64
    for seen in again.sample:
        assert np.allclose(again.network.commands(seen), weights().network.commands(seen), atol=1e-3)


def played(made: Weights) -> tuple[Any, PhysicsBackend]:
    """How a round ends in which the faucet is to be turned on with these weights."""
    ready, backend = get_ready(
        {}, SKILLS[SKILL], "faucet", 3, style="modern_1", layout="one_wall_large",
        make=partial(PhysicsBackend, controllers={SKILL: partial(Learned, made)}),
    )  # fmt: skip
    return backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT], backend


def test_targets_that_were_never_shown_stay_scripted() -> None:
    made = replace(weights(), about=replace(weights().about, targets=("stove",)))
    outcome, _ = played(made)
    assert outcome.success, "the faucet is turned on by the scripted controller; these weights stand still"


def test_a_policy_that_stands_still_ends_and_has_achieved_nothing() -> None:
    outcome, _ = played(weights())
    assert (outcome.status, outcome.reason) == ("failure", "slipped")
    assert outcome.seconds < 5.0


def test_a_policy_that_never_stops_is_ended_with_a_reason() -> None:
    outcome, backend = played(weights(travel=0.03))
    assert outcome.status == "failure" and outcome.reason in ("timeout", "blocked", "slipped")
    assert np.isfinite(backend.positions()).all()


def said(answer: Callable[[int], Any]) -> Weights:
    """Weights whose network says whatever it is told to, by the number of the chunk."""
    made = replace(weights())
    object.__setattr__(made, "network", _Saying(answer))
    return made


class _Saying:
    """A network that is none."""

    chunk = CHUNK

    def __init__(self, answer: Callable[[int], Any], heard: list[Any] | None = None) -> None:
        self._answer, self._asked, self._heard = answer, -1, [] if heard is None else heard

    def commands(self, seen: Any) -> Any:
        self._asked += 1
        self._heard.append(seen)
        return self._answer(self._asked)


def filled(value: float, *shape: int) -> Any:
    return np.full(shape or (CHUNK, COMMANDED), value, np.float32)


def raising(asked: int) -> Any:
    raise RuntimeError("out of order")


@pytest.mark.parametrize(("answer", "told"), [
    (lambda asked: filled(np.nan), "not finite"),
    (lambda asked: filled(np.inf), "not finite"),
    (lambda asked: filled(0.0, CHUNK, COMMANDED - 1), ""),
    (lambda asked: "turn left", ""),
    (raising, "out of order"),
])  # fmt: skip
def test_what_a_network_says_that_is_no_motion_reaches_no_servo(answer: Callable[[int], Any], told: str) -> None:
    outcome, backend = played(said(answer))
    assert (outcome.status, outcome.reason) == ("failure", "invalid"), outcome
    assert told in outcome.detail
    assert np.isfinite(backend.positions()).all()


@pytest.mark.long
def test_wishes_beyond_all_measure_are_cut_to_what_a_robot_can_do() -> None:
    outcome, backend = played(said(lambda asked: filled(1e30)))
    assert outcome.status == "failure" and outcome.reason in ("blocked", "slipped", "timeout", "invalid"), outcome
    assert np.isfinite(backend.positions()).all()


@pytest.mark.long
def test_a_policy_that_waves_for_ever_is_ended_after_its_time() -> None:
    outcome, backend = played(said(lambda asked: filled(0.05 if asked % 2 else -0.05)))
    assert (outcome.status, outcome.reason) == ("failure", "timeout"), outcome
    assert "come to rest" in outcome.detail and outcome.seconds < 60.0
    assert np.isfinite(backend.positions()).all()


WORDS = ("door", "faucet", "on", "turn")


def together(**told: Any) -> Weights:
    """Weights of one network for two skills, which is told words."""
    inputs = len(entries(SKILLS[SKILL])) + len(WORDS)
    rng, one = np.random.default_rng(2), network(travel=1e-9)
    layer = one.layers[0]
    wide = replace(
        one, mean=np.zeros(inputs, np.float32), std=np.ones(inputs, np.float32),
        layers=((rng.normal(size=(8, inputs)).astype(np.float32), *layer[1:]),),
    )  # fmt: skip
    told = {"skill": SEVERAL, "skills": ("open door", SKILL), "targets": (), "words": WORDS, "execute": CHUNK} | told
    return Weights(about=About(**told), network=wide, sample=rng.normal(size=(2, inputs)).astype(np.float32))


def test_a_network_for_several_skills_is_found_for_each_of_them(tmp_path: Path) -> None:
    save_weights(tmp_path / file_name(SEVERAL), together())
    found = learned_skills(str(tmp_path), 1)
    assert set(found) == {"open door", SKILL}
    assert bag(found[SKILL].about.words, "turn on faucet").tolist() == [0.0, 1.0, 1.0, 1.0]
    save_weights(tmp_path / file_name(SKILL), weights())
    assert learned_skills(str(tmp_path), 1)[SKILL].about.skill == SKILL, "a skill's own weights come first"


@pytest.mark.parametrize(
    "told", [{"skills": ()}, {"skills": ("juggle",)}, {"words": ("a", "b")}, {"words": (1, 2, 3, 4)}]
)
def test_a_network_for_several_skills_is_refused(told: dict[str, Any], tmp_path: Path) -> None:
    save_weights(tmp_path / "Several.npz", together(**told))
    with pytest.raises(OptionError, match="valid"):
        read_weights(tmp_path / "Several.npz")


def test_a_network_for_several_skills_is_told_the_words_of_the_command() -> None:
    heard: list[np.ndarray] = []

    def answer(asked: int) -> Any:
        return filled(0.0)

    made = together()
    object.__setattr__(made, "network", _Saying(answer, heard))
    outcome, _ = played(made)
    assert outcome.reason == "slipped" and heard[0][-4:].tolist() == [0.0, 1.0, 1.0, 1.0]


def test_weights_of_another_skill_are_not_played() -> None:
    outcome, _ = played(weights("open door"))
    assert outcome.reason == "invalid" and "open door" in outcome.detail


class _Stops:
    """Does as the scripted controller does, until its fingers have been round something for a while."""

    def __init__(self, pilots: list[Any]) -> None:
        self._pilots = pilots

    def run(self, subtask: Subtask, sensing: Any) -> Any:
        held = 0
        for command in self._pilots[0].wanted(subtask, sensing):
            yield command
            held += feels(sensing.body)
            if held > 3:
                return Outcome("success")
        raise AssertionError("it has never taken hold of anything")


@pytest.mark.long
@pytest.mark.parametrize(
    ("skill", "target"), [("open door", "cabinet"), ("close door", "cabinet"), ("turn on", "stove")]
)
def test_a_policy_that_stops_with_its_fingers_round_a_handle_bars_nothing_that_follows(skill: str, target: str) -> None:
    pilots: list[Any] = []
    ready, backend = get_ready(
        {}, SKILLS[skill], target, 3, style="modern_1", layout="one_wall_large",
        make=partial(PhysicsBackend, controllers={skill: lambda: _Stops(pilots)}),
    )  # fmt: skip
    pilots.append(backend.by_hand(ROBOT, ready.subtask)._pilot)
    assert not backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT].success
    for text in (("navigate to", "sink"), ("navigate to", "vegetable"), ("pick up", "vegetable")):
        assert backend.run_round({ROBOT: Subtask(*text)}).outcomes[ROBOT].success, text
