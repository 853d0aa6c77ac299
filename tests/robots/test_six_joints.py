"""A body with another arm, hand and base, by the recipe of docs/extending.md: it stands, drives and acts."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import skills
from six_joints import A2, A3, D1, D4, D5, D6, GRIP, MOUNT, SixJoints

import remac_env
from remac_env.backends.physics.controllers.base import Command
from remac_env.backends.physics.controllers.learned.library import file_name
from remac_env.backends.physics.controllers.learned.network import HAND, Network, commanded
from remac_env.backends.physics.controllers.learned.seen import entries
from remac_env.backends.physics.controllers.learned.weights import About, Weights, save_weights
from remac_env.errors import KitchenFileError, OptionError, UncertifiedWarning
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_model
from remac_env.kitchen.fixtures import certificate_files, certificates
from remac_env.lowlevel.env import SkillEnv
from remac_env.robots import bodies
from remac_env.robots.rotation import about_x, about_z
from remac_env.robots.tracking import bare_model
from remac_env.rules.skills import SKILLS

CERTIFIED = {"layout": "one_wall_large", "style": "modern_1"}
CHAINS = {chain["name"]: chain for chain in tomllib.loads(skills.CHAINS.read_text("utf-8"))["chain"]}


@pytest.fixture
def body() -> Iterator[SixJoints]:
    """The body, known for as long as a test lasts."""
    made = SixJoints()
    bodies.register_body(made)
    yield made
    bodies._BODIES.pop(made.name)


def drawn(rng: np.random.Generator) -> np.ndarray:
    """A configuration (10,) within limits."""
    base = np.concatenate([rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0, 1)])
    return np.concatenate([base, rng.uniform(SixJoints.lower[3:], SixJoints.upper[3:])])


def test_closed_form_and_model_agree() -> None:
    kinematics, rng = SixJoints().kinematics(), np.random.default_rng(0)
    for _ in range(60):
        q = drawn(rng)
        position, rotation = kinematics.forward(q)
        found = kinematics.solutions(position, rotation, q[:3], lifts=q[3:4])
        assert np.abs(found - q).max(axis=1).min() < 1e-6
        for other in found:
            place, turn = kinematics.forward(other)
            assert np.abs(place - position).max() < 1e-9 and np.abs(turn - rotation).max() < 1e-9


def test_the_hand_is_led_to_a_pose() -> None:
    body = SixJoints()
    kinematics, q = body.kinematics(), np.array([0.0, 0.0, 0.0, 0.1, 0.2, -1.8, 2.0, -1.6, -1.4, 0.3])
    position, rotation = kinematics.forward(q)
    position = position + [0.03, -0.02, 0.04]
    for _ in range(4):
        q = kinematics.track(q, position, rotation, largest=body.speed * 0.05).q
    assert np.linalg.norm(kinematics.forward(q)[0] - position) < 1e-3


def test_the_arm_is_that_of_the_makers_table() -> None:
    """Row by row: a turn by theta and a way d along z, a way a and a turn alpha along x."""
    table = [(0, D1, 0.5), (A2, 0, 0), (A3, 0, 0), (0, D4, 0.5), (0, D5, -0.5), (0, D6, 0)]  # a, d, alpha in half turns
    kinematics, rng = SixJoints().kinematics(), np.random.default_rng(1)
    for _ in range(5):
        q = drawn(rng)
        place, turn = np.array([*q[:2], MOUNT + q[3]]), about_z(q[2] + np.pi)
        for theta, (a, d, alpha) in zip(q[4:], table, strict=True):
            turned = turn @ about_z(theta)
            place = place + turned @ [a, 0.0, d]
            turn = turned @ about_x(alpha * np.pi)
        position, rotation = kinematics.forward(q)
        np.testing.assert_allclose(position, place + GRIP * turn[:, 2], atol=1e-7)
        np.testing.assert_allclose(rotation, turn @ about_z(0.5 * np.pi), atol=1e-7)


def test_a_kitchen_holds_what_the_body_says(body: SixJoints) -> None:
    for robots, visual in ((("robot_0", "robot_1", "robot_2"), False), (("robot_0",), True)):
        names = [f"{robot}/{part}" for robot in robots for part in (*body.joints, *body.fingers)]
        model = build_model(layouts.load("one_wall_large"), robots=robots, objects={}, body=body, visual=visual)
        joints = [model.joint(number).name for number in range(model.njnt)]
        assert [name for name in joints if name.startswith("robot_")] == names
        assert [model.actuator(number).name for number in range(model.nu)] == names


def test_its_certificates_lie_beside_it_and_count_for_it_alone(body: SixJoints) -> None:
    """They are of one layout in one style: nothing else is certified with it, and with a changed one nothing at all."""
    assert certificate_files.file_of(body.name) == Path(__file__).parent / "certified" / "six joints.toml"
    layout, other = (layouts.load("one_wall_large", styles.load(name).models) for name in ("modern_1", "rustic"))
    assert certificates.uncertified(layout, body.name) == ()
    assert "cabinet" in certificates.uncertified(other, body.name)
    with pytest.warns(UncertifiedWarning, match="'six joints' nothing is certified of .*cabinet"):
        certificates.warn_uncertified(other, body.name)
    known = certificate_files.load(body.name)
    body.lower = body.lower + 1e-3
    with pytest.raises(KitchenFileError, match="body 'six joints' has changed since the proof"):
        certificates.check(layout, "odd.toml", known, body=body.name)


@pytest.mark.filterwarnings("error::remac_env.errors.UncertifiedWarning")
def test_it_opens_a_door_takes_something_and_puts_it_in(body: SixJoints) -> None:
    env = remac_env.parallel_env("OpenCabinetPnP", robots=1, body=body.name, **CERTIFIED)
    env.reset(seed=1)
    for text in (
        "navigate to cabinet", "open cabinet door", "navigate to vegetable", "pick up vegetable", "navigate to cabinet",
        "place to cabinet",
    ):
        _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(text)})
        outcome = infos["robot_0"]["outcome"]
        assert outcome["status"] == "success", (text, outcome)
    assert infos["robot_0"]["success"] and infos["robot_0"]["robot_contacts"] == 0
    assert env.render_work().shape == (648, 768, 3)  # cameras know where it looks
    env.close()


@pytest.mark.parametrize("control", ["joints", "ee"])
def test_actions_and_observations_are_as_long_as_it_has_joints(body: SixJoints, control: str) -> None:
    cell: dict[str, Any] = {"target": "faucet", "layout": "one_wall_large", "style": "modern_1", "control": control}
    env, other = SkillEnv("TurnOn", body=body.name, **cell), SkillEnv("TurnOn", **cell)
    assert len(other.observation_names) - len(env.observation_names) == 1
    assert len(env.action_names) == 11  # with joints 4 of the base and the lift, 6, and the fingers; else 6 of the hand
    observation, _ = env.reset(seed=2)
    assert env.observation_space.contains(observation)
    command = Command(env._manual.q, env._manual.grip)
    assert command.q.shape == (10,)
    observation, *_ = env.step(np.full(11, 0.1, np.float32))
    assert env.observation_space.contains(observation)
    env.close()


def standing_still(skill: str, body: str, *, hand: bool) -> Weights:
    """A network that leaves every joint, and the hand, where it is."""
    inputs, size = len(entries(SKILLS[skill], body)), commanded(bodies.get(body)) + HAND * hand
    layer = tuple(np.zeros(shape, np.float32) for shape in ((4, inputs), (4,), (4,), (4,)))
    last, out = (np.zeros((size, 4), np.float32), np.zeros(size, np.float32)), np.zeros((1, size), np.float32)
    network = Network(np.zeros(inputs, np.float32), np.ones(inputs, np.float32), (layer,), last, out, out + 1)  # type: ignore[arg-type]
    about = About(skill=skill, targets=(), execute=1)
    return Weights(about=about, network=network, sample=np.zeros((1, inputs), np.float32))


@pytest.mark.parametrize("hand", [False, True])
@pytest.mark.filterwarnings("ignore::remac_env.errors.UncertifiedWarning")
def test_what_was_learnt_with_it_moves_it_and_no_other(body: SixJoints, tmp_path: Path, hand: bool) -> None:
    save_weights(tmp_path / file_name("turn on"), standing_still("turn on", body.name, hand=hand), body.name)
    kitchen: dict[str, Any] = {"robots": 1, "layout": "one_wall_large", "skills": str(tmp_path)}
    with pytest.raises(OptionError, match=f"made for body '{body.fingerprint}', .*train it with 'panda' .*scripted"):
        remac_env.parallel_env("HeatOnStove", **kitchen)
    other = f"learnt with body 'panda', got body='{body.name}'; valid: scripted, or weights of your own: remac learn"
    with pytest.raises(OptionError, match=other):
        remac_env.parallel_env("HeatOnStove", **kitchen | {"skills": "learned"}, body=body.name)
    env = remac_env.parallel_env("HeatOnStove", **kitchen, body=body.name)
    assert len(env.skills["turn on"]) == 64 and env.skills["pick up"] == "scripted"
    env.reset(seed=1)
    outcomes = []
    for text in ("navigate to stove", "turn on stove"):
        infos = env.step({"robot_0": env.vocabulary.encode(text)})[-1]
        outcomes.append((infos["robot_0"]["outcome"]["status"], infos["robot_0"]["outcome"]["reason"]))
    assert outcomes == [("success", ""), ("failure", "slipped")]  # it stood still: no exception, and nothing was done
    env.close()


def test_a_model_with_other_joints_than_it_says_is_refused() -> None:
    class Wrong(SixJoints):
        joints = (*SixJoints.joints[:-2], "wrist3", "wrist2")

    with pytest.raises(OptionError, match=r"body 'six joints' has the joints .*'wrist2', 'wrist3'.*; valid"):
        bare_model(Wrong())


def test_at_rest_nothing_of_it_touches_anything(body: SixJoints) -> None:
    model = build_model(layouts.load("one_wall_large"), robots=("robot_0",), objects={}, body=body)
    data = mujoco.MjData(model)
    for part, value in zip(body.joints, body.tuck(0.0, -1.6, 0.5 * np.pi), strict=True):
        data.joint(f"robot_0/{part}").qpos[0] = value
    mujoco.mj_forward(model, data)
    own = [model.geom_bodyid[pair] for pair in data.contact.geom[: data.ncon]]
    assert [[model.body(each).name for each in pair] for pair in own] == []


@pytest.mark.long
@pytest.mark.filterwarnings("ignore::remac_env.errors.UncertifiedWarning")
@pytest.mark.parametrize("name", CHAINS)
def test_scripted_skills_work_with_it(body: SixJoints, name: str) -> None:
    for seed in range(182000, 182003):
        trials = skills.run_chain(CHAINS[name], seed, style=None, layout=None, perception_noise=0.0, body=body.name)
        failed = [trial for trial in trials if trial.outcome is not None and not trial.outcome.success]
        assert len(failed) <= 1, failed
