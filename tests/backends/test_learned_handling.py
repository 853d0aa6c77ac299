"""Learned skills that take and put objects: where they are played, how they bring the hand there, and how they end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.learned import controller
from remac_env.backends.physics.controllers.learned.aims import aim_of
from remac_env.backends.physics.controllers.learned.controller import Learned
from remac_env.backends.physics.controllers.learned.hand import hands, towards_hand
from remac_env.backends.physics.controllers.learned.network import HAND, Network, commanded
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.backends.physics.controllers.learned.weights import About, Weights, read_weights, save_weights
from remac_env.lowlevel.starts import ROBOT, get_ready
from remac_env.robots import bodies
from remac_env.rules.skills import SKILLS

CHUNK = 4
COMMANDED = commanded(bodies.get())
WITH_HAND = COMMANDED + HAND
HANDLED = {"pick up": ("vegetable", "food on surface"), "place to": ("plate", "food in vessel on cavity")}


def weights(skill: str, answer: float = 0.0, **told: Any) -> Weights:
    """A network that says the same whatever it sees, hand included."""
    inputs = len(entries(SKILLS[skill]))
    zeros = np.zeros((CHUNK, WITH_HAND), np.float32)
    layer = (np.zeros((4, inputs), np.float32), *[np.zeros(4, np.float32)] * 3)
    last = (np.zeros((zeros.size, 4), np.float32), np.full(zeros.size, answer, np.float32))
    network = Network(
        np.zeros(inputs, np.float32), np.ones(inputs, np.float32), (layer,), last, zeros, np.ones_like(zeros)
    )
    about = About(skill=skill, targets=(), execute=CHUNK, cases=(f"{skill} {HANDLED[skill][1]}",))
    return Weights(about=replace(about, **told), network=network, sample=np.ones((2, inputs), np.float32))


def played(made: Weights) -> tuple[Any, PhysicsBackend, str]:
    """How a round ends in which it is handled with these weights."""
    skill = made.about.skill
    ready, backend = get_ready(
        {}, SKILLS[skill], HANDLED[skill][0], 3, style="modern_1", layout="one_wall_large",
        make=partial(PhysicsBackend, controllers={skill: partial(Learned, made)}),
    )  # fmt: skip
    return backend.run_round({ROBOT: ready.subtask}).outcomes[ROBOT], backend, ready.case


def test_a_policy_that_stands_still_takes_nothing() -> None:
    outcome, _, case = played(weights("pick up"))
    assert case == "food on surface"
    assert (outcome.status, outcome.reason) == ("failure", "slipped"), outcome


@pytest.mark.parametrize("told", [
    {"cases": ("pick up vessel on surface", "place to food on surface")},
    {"measured": {"pick up food on surface: here": {"trials": 10, "successes": 8}}},
], ids=["never shown", "measured to fail too often"])  # fmt: skip
def test_what_it_cannot_do_stays_scripted(told: dict[str, Any]) -> None:
    outcome, backend, _ = played(weights("pick up", **told))
    assert outcome.success and backend.world.robots[ROBOT].holding == "vegetable", outcome


def test_all_sets_of_trials_count_together() -> None:
    measured = {
        "pick up food on surface: here": {"trials": 10, "successes": 10},
        "pick up food on surface: there": {"trials": 10, "successes": 8},
        "pick up vessel on surface: there": {"trials": 10, "successes": 0},
    }
    cases = ("pick up food on surface", "pick up vessel on surface")
    about = replace(weights("pick up").about, measured=measured, cases=cases)
    assert about.shown("pick up") == ("food on surface", "vessel on surface") and about.shown("place to") == ()
    assert about.played("pick up") == ("food on surface",) and about.plays("pick up", "kiwi", "food on surface")
    assert not about.plays("pick up", "plate", "vessel on surface")
    assert not about.plays("pick up", "kiwi", "food on basin")


@pytest.mark.parametrize("skill", HANDLED)
@pytest.mark.parametrize(("answer", "told"), [
    (lambda: np.full((CHUNK, WITH_HAND), np.nan, np.float32), "not finite"),
    (lambda: np.full((CHUNK, COMMANDED - 1), 0.0, np.float32), ""),
    (lambda: "take it", ""),
])  # fmt: skip
@pytest.mark.long
def test_what_a_network_says_that_is_no_motion_reaches_no_servo(
    skill: str, answer: Callable[[], Any], told: str
) -> None:
    made = weights(skill)
    object.__setattr__(made, "network", _Saying(answer))
    outcome, backend, _ = played(made)
    assert (outcome.status, outcome.reason) == ("failure", "invalid") and told in outcome.detail, outcome
    assert np.isfinite(backend.positions()).all()


@pytest.mark.long
@pytest.mark.parametrize("skill", HANDLED)
def test_a_policy_that_never_stops_is_ended_with_a_reason(skill: str) -> None:
    outcome, backend, _ = played(weights(skill, 0.03))
    assert outcome.status == "failure" and outcome.reason in ("timeout", "blocked", "slipped", "dropped"), outcome
    assert np.isfinite(backend.positions()).all()


class _Saying:
    """A network that is none."""

    chunk = CHUNK

    def __init__(self, answer: Callable[[], Any]) -> None:
        self._answer = answer

    def commands(self, seen: Any) -> Any:
        return self._answer()


@pytest.mark.parametrize(("achieved", "holds"), [(True, False), (True, True), (False, False)])
def test_a_policy_that_goes_on_when_all_is_done_is_ended_once_its_hand_is_empty(
    achieved: bool, holds: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    skill = SKILLS["pick up"]
    ready, backend = get_ready({}, skill, "vegetable", 3, style="modern_1", layout="one_wall_large")
    sensing = backend.by_hand(ROBOT, ready.subtask).sensing
    aim = SimpleNamespace(
        achieved=lambda: achieved, over=lambda: False, update=lambda: None, patience=999, by_hand=True
    )
    aim.stand = aim_of(ready.subtask, sensing).stand
    for name, value in (("aim_of", lambda *told: aim), ("feels", lambda body: holds), ("observe", lambda *told: [0.0])):
        monkeypatch.setattr(controller, name, value)
    made = weights("pick up")
    object.__setattr__(made, "network", _Saying(lambda: np.zeros((CHUNK, COMMANDED), np.float32)))
    run = Learned(made).run(ready.subtask, sensing)
    commands = list(run)
    assert (len(commands) == 12 * CHUNK) == (achieved and not holds)
    assert len(commands) in (12 * CHUNK, controller.LONGEST)


@pytest.mark.parametrize(("began", "opening", "wanted", "told"), [
    (0.029, 0.062, (0.030, 0.034, 0.028), (0.029, 0.029, 0.029)),  # held as it was, whatever drifts
    (0.029, 0.062, (0.034, 0.035, 0.030), (0.029, 0.035, 0.030)),  # let go, and then as the network says
    (0.000, 0.005, (0.001, 0.0), (0.001, 0.0)),  # a vessel's rim, pressed as hard as can be
    (0.037, 0.078, (0.0384, 0.0388), (0.037, 0.0388)),  # hardly thinner than the hand opens
    (0.040, 0.080, (0.030, 0.001), (0.030, 0.001)),  # nothing is held: the hand closes
    (0.000, 0.0, (0.001,), (0.001,)),
])  # fmt: skip
def test_what_is_held_gently_stays_held_until_it_is_let_go_for_certain(
    began: float, opening: float, wanted: tuple[float, ...], told: tuple[float, ...]
) -> None:
    felt: Any = SimpleNamespace(commanded_opening=began, opening=opening)
    grip = controller._Grip(felt, bodies.get().finger_travel)
    assert [grip.told(each) for each in wanted] == pytest.approx(list(told))


@pytest.mark.long
def test_nothing_is_let_go_far_from_where_it_is_to_be_put() -> None:
    made, wide = weights("place to"), np.zeros((CHUNK, COMMANDED), np.float32)
    wide[:, COMMANDED - 1] = 0.04  # m that each finger is to open
    object.__setattr__(made, "network", _Saying(lambda: wide))
    outcome, backend, _ = played(made)
    assert outcome.reason == "slipped" and "let go far" in outcome.detail, outcome
    assert backend.world.robots[ROBOT].holding == "vegetable"


@pytest.mark.parametrize(("noun", "away", "held"), [
    ("pan", 0.20, True), ("pan", 0.35, False), ("bowl", 0.12, True), ("vegetable", 0.02, True),
    ("vegetable", 0.20, False),
])  # fmt: skip
def test_an_object_is_in_the_hand_as_far_off_as_it_is_grasped(noun: str, away: float, held: bool) -> None:
    ready, backend = get_ready({}, SKILLS["pick up"], noun, 3, style=None, layout="one_wall_large")
    real = backend.by_hand(ROBOT, ready.subtask).sensing
    lay = real.pose(noun)
    hand = replace(lay, position=lay.position + [away, 0.0, 0.0])
    body = SimpleNamespace(opening=0.02, commanded_opening=0.0, grip=hand)
    sensing: Any = SimpleNamespace(
        body=body, objects=real.objects, layout=real.layout, station=real.station, goal=None, told=real.told,
        name=ROBOT, pose=lambda name: lay,
    )  # fmt: skip
    aim = aim_of(ready.subtask, sensing)
    assert (aim.done() > 0.0) == held and not aim.over()
    lay = replace(lay, position=lay.position + [0.0, 0.0, 0.11])
    body.grip = replace(hand, position=hand.position + [0.0, 0.0, 0.11])
    assert aim.over() == held, "once it has risen"


def test_putting_down_is_over_once_the_hand_is_empty_and_clear_wherever_the_object_lies() -> None:
    ready, backend = get_ready({}, SKILLS["place to"], "plate", 3, style="modern_1", layout="one_wall_large")
    manual = backend.by_hand(ROBOT, ready.subtask)
    q, grip, over = manual.q, manual.grip, []
    for period in range(60):
        q[3] += 0.008 if period < 20 or period >= 30 else 0.0  # up with it, 10 periods to let go, and up without it
        manual.command(np.minimum(q, bodies.get().upper), grip if period < 20 else 0.04)
        over.append(manual.aim.over())
    assert not any(over[:36]), "the hand has gone far with it, and let it go, but is not clear of where that was"
    assert over[-1] and not manual.aim.achieved(), "it has fallen beside the plate, and there is no more to do"


def test_the_arm_goes_where_the_hand_is_wanted_and_the_base_where_it_was_told() -> None:
    kinematics, stand = bodies.get().kinematics(), Stand(np.array([1.0, 2.0, 0.0]), np.eye(3), 0.5 * np.pi)
    told = np.array([0.1, 0.2, 0.05, 0.1, 0.2, 0.1, -0.1, -2.2, 0.1, 2.4, 0.7])
    wanted = hands(np.append(told, 0.04)[None], bodies.get())[0].astype(float)
    q = np.array(told)
    q[:3] += [1.0, 2.0, 0.5 * np.pi]
    off = q + np.array([0.0] * 4 + [0.03, -0.03, 0.02, 0.03, -0.02, 0.02, 0.03])
    hand = kinematics.forward(off)[0]
    command = np.concatenate([np.zeros(COMMANDED), wanted[:3] + stand.origin - hand, wanted[3:]])
    came = towards_hand(kinematics, stand, off, hand, command)
    assert np.allclose(kinematics.forward(came)[0], kinematics.forward(q)[0], atol=1e-3)
    assert np.array_equal(came[:4], off[:4])
    command[COMMANDED + 3 :] = 0.0  # axes of no length say nothing
    assert np.array_equal(towards_hand(kinematics, stand, off, hand, command), off)


def test_files_without_cases_are_read_as_before(tmp_path: Path) -> None:
    save_weights(tmp_path / "PickUp.npz", weights("pick up", cases=()))
    about = read_weights(tmp_path / "PickUp.npz").about
    assert about.cases == () and about.plays("pick up", "kiwi", "food on basin")
