"""Skills as Gymnasium environments: contracts, starts, actions, judgement and rewards."""

from __future__ import annotations

import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env

import remac_env  # noqa: F401 - enters the ids
from remac_env.backends.physics.controllers.base import in_room
from remac_env.errors import ActionError, OptionError, PhysicsError, UncertifiedWarning, UnknownNameError
from remac_env.lowlevel import starts
from remac_env.lowlevel.names import skills
from remac_env.lowlevel.options import targets
from remac_env.robots import bodies
from remac_env.robots.panda.body import Panda
from remac_env.robots.rotation import about_z
from remac_env.rules.skills import SKILLS

NAMES = tuple(skills())
PICTURES = ("front", "side", "wrist")


def first(name: str) -> list[Any]:
    """One skill in the fast tests, all others in the long ones."""
    return [name, *(pytest.param(other, marks=pytest.mark.long) for other in NAMES if other != name)]


def make(skill: str, **options: Any) -> Any:
    return gymnasium.make(f"RemacSkill-{skill}-v0", **options)


@pytest.fixture
def faucet() -> Iterator[Any]:
    env = make("TurnOn", target="faucet", layout="one_wall_large", style="modern_1").unwrapped
    yield env
    env.close()


def test_every_skill_with_a_target_has_an_environment() -> None:
    assert set(NAMES) == {
        "NavigateTo", "PickUp", "PlaceTo", "OpenDoor", "CloseDoor", "TurnOn", "TurnOff", "Season"
    }  # fmt: skip
    assert all(f"RemacSkill-{name}-v0" in gymnasium.registry for name in NAMES)
    assert all(targets(SKILLS[row.name]) for row in skills().values())


@pytest.mark.parametrize("skill", first("TurnOn"))
@pytest.mark.parametrize("control", ["ee", pytest.param("joints", marks=pytest.mark.long)])
def test_gymnasiums_own_check_is_content(skill: str, control: str, recwarn: pytest.WarningsRecorder) -> None:
    env = make(skill, control=control, layout="one_wall_large").unwrapped
    check_env(env, skip_render_check=True)
    env.close()
    assert not [str(warning.message) for warning in recwarn if "gym" in str(warning.filename)]


@pytest.mark.parametrize("skill", first("PickUp"))
def test_the_same_seed_and_actions_give_the_same_episode_after_any_other(skill: str) -> None:
    def play(env: Any) -> list[Any]:
        observation, info = env.reset(seed=3)
        found = [observation, info["start"]]
        rng = np.random.default_rng(0)
        for _ in range(5):
            found.append(env.step(rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)))
        return found

    one, other = make(skill).unwrapped, make(skill).unwrapped
    other.reset(seed=4)
    for mine, yours in zip(play(one), play(other), strict=True):
        np.testing.assert_equal(mine, yours)


@pytest.mark.parametrize("control", ["joints", "ee"])
def test_names_units_and_ranges_stand_for_every_number(control: str) -> None:
    env = make("TurnOn", control=control).unwrapped
    for names, space in ((env.action_names, env.action_space), (env.observation_names, env.observation_space)):
        assert len({entry.name for entry in names}) == len(names) == space.shape[0]
        assert all(entry.low < entry.high for entry in names)
    observation, info = env.reset(seed=1)
    assert env.observation_space.contains(observation)
    assert info["command"] == env.task_description == "turn on " + info["start"]["target"]


@pytest.mark.parametrize("name", ["torso", "joint2", "base_left"])
def test_an_action_moves_what_its_name_says_as_far_as_its_range_says(faucet: Any, name: str) -> None:
    names = [entry.name for entry in faucet.action_names]
    action = np.zeros(len(names), np.float32)
    action[names.index(name)] = 1.0
    faucet.reset(seed=2)
    before = faucet._manual.q
    faucet.step(action)
    moved = faucet._manual.q - before
    high = faucet.action_names[names.index(name)].high
    assert np.linalg.norm(moved) == pytest.approx(high, rel=1e-6)


@pytest.mark.parametrize(("axis", "way"), [("forward", (1, 0, 0)), ("left", (0, 1, 0)), ("up", (0, 0, 1))])
def test_the_hand_goes_along_the_axes_of_the_base(axis: str, way: tuple[int, int, int]) -> None:
    env = make("TurnOn", target="faucet", layout="one_wall_large", style="modern_1", control="ee").unwrapped
    names = [entry.name for entry in env.action_names]
    action = np.zeros(len(names), np.float32)
    action[names.index("fingers")] = 1.0
    env.reset(seed=2)
    turned = env._manual.q[2]
    kinematics = bodies.get().kinematics()
    before, _ = kinematics.forward(env._manual.q)
    action[names.index(f"hand_{axis}")] = 1.0
    for _ in range(4):
        env.step(action)
    after, _ = kinematics.forward(env._manual.q)
    c, s = np.cos(turned), np.sin(turned)
    moved = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) @ (after - before)
    assert moved @ way > 0.05
    assert np.linalg.norm(np.cross(moved, way)) < 0.5 * (moved @ way)  # folded, it cannot go straight at full speed


@pytest.fixture
def slow() -> Iterator[Panda]:
    """A Panda on a lower base whose joints go half as fast."""
    body = Panda(name="slow panda", mount_height=0.62)
    body.speed = 0.5 * body.speed
    bodies.register_body(body)
    yield body
    bodies._BODIES.pop(body.name)


@pytest.mark.parametrize("control", ["joints", "ee"])
def test_ranges_steps_and_kinematics_are_those_of_the_body(slow: Panda, control: str) -> None:
    cell = {"target": "faucet", "layout": "one_wall_large", "style": "modern_1", "control": control}
    env = make("TurnOn", body=slow.name, **cell).unwrapped
    names = [entry.name for entry in env.action_names]
    turn = env.action_names[names.index("base_turn")].high
    assert turn == pytest.approx(0.05 * slow.speed[2]) == 0.5 * make("TurnOn", **cell).unwrapped.action_names[
        names.index("base_turn")
    ].high
    with pytest.warns(UncertifiedWarning, match="slow panda"):
        observation, _ = env.reset(seed=2)
    assert env.observation_space.contains(observation) and env._ready.start.body == env._manual.body == slow.name
    assert env._backend.model.body("robot_0/lift").pos[2] == pytest.approx(0.62)
    action, before = np.zeros(len(names), np.float32), env._manual.q
    action[names.index("base_turn")] = 1.0
    env.step(action)
    assert (env._manual.q - before)[2] == pytest.approx(turn, rel=1e-6)
    if control == "ee":  # the hand is where this body's arm has it
        place = slow.kinematics().forward(env._manual.q)[0] - [*env._manual.q[:2], env._manual.q[3]]
        assert np.linalg.norm(place - env._control._pose[0] @ about_z(env._manual.q[2]).T) < 0.02
    env.close()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_never_reaches_the_simulator(faucet: Any, bad: float) -> None:
    faucet.reset(seed=1)
    before = faucet._backend.positions()
    action = np.zeros(12, np.float32)
    action[4] = bad
    with pytest.raises(ActionError, match="joint1"):
        faucet.step(action)
    with pytest.raises(ActionError, match="shape"):
        faucet.step(np.zeros(3, np.float32))
    assert np.array_equal(before, faucet._backend.positions())
    with pytest.raises(PhysicsError, match="not finite"):
        faucet._manual.command(np.full(11, bad), 0.04)
    assert np.array_equal(before, faucet._backend.positions())


def test_numbers_beyond_the_range_count_as_its_ends(faucet: Any) -> None:
    found = []
    for scale in (1.0, 7.0):
        faucet.reset(seed=1)
        found.append(faucet.step(np.full(12, scale, np.float32))[0])
    assert np.array_equal(*found)


def test_a_simulation_that_breaks_ends_the_episode_with_a_reason(faucet: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    faucet.reset(seed=1)

    def breaks(q: Any, grip: Any) -> None:
        raise PhysicsError("MuJoCo warned")

    monkeypatch.setattr(faucet._manual, "command", breaks)
    observation, reward, terminated, truncated, info = faucet.step(np.zeros(12, np.float32))
    assert (reward, terminated, truncated, info["broken"]) == (0.0, False, True, "MuJoCo warned")
    assert np.isfinite(observation).all()
    with pytest.raises(ResetNeeded):
        faucet.step(np.zeros(12, np.float32))


def test_wrong_names_are_refused_before_anything_is_built() -> None:
    with pytest.raises(UnknownNameError, match="cabinet, microwave"):
        make("OpenDoor", target="faucet")
    with pytest.raises(UnknownNameError, match="octopus.*panda"):
        make("OpenDoor", body="octopus")
    with pytest.raises(UnknownNameError, match="joints, ee"):
        make("OpenDoor", control="torques")
    env = make("OpenDoor", layout="igloo").unwrapped
    with pytest.raises(UnknownNameError, match="one_wall_large"):
        env.reset(seed=0)
    with pytest.raises(OptionError, match="seed"):
        env.reset(seed=-1)
    with pytest.raises(ResetNeeded):
        make("OpenDoor").unwrapped.step(np.zeros(12, np.float32))


def scripted(env: Any, seed: int) -> list[tuple[float, bool, dict[str, Any]]]:
    """The scripted skill, played through the environment's own way of commanding the robot."""
    env.reset(seed=seed)
    found = []
    for wanted in env._manual.scripted():
        found.append(_as_step(env, in_room(wanted.q, wanted.frame), wanted.opening))
        if found[-1][1]:
            return found
    for _ in range(10):
        found.append(_as_step(env, env._manual.q, env._manual.grip))
    return found


def _as_step(env: Any, q: Any, grip: float) -> tuple[float, bool, dict[str, Any]]:
    env._control.apply = lambda action: (q, grip)
    _, reward, terminated, _, info = env.step(np.zeros(env.action_space.shape, np.float32))
    return reward, terminated, info


@pytest.mark.parametrize("skill", first("TurnOn"))
@pytest.mark.parametrize("seed", [5, pytest.param(6, marks=pytest.mark.long), pytest.param(7, marks=pytest.mark.long)])
def test_what_the_scripted_skill_does_is_judged_as_success(skill: str, seed: int) -> None:
    if skill == "NavigateTo":
        pytest.skip("drives are planned for all robots together")
    env = make(skill, reward="progress").unwrapped
    steps = scripted(env, seed)
    assert steps[-1][2]["is_success"] or any(terminated for _, terminated, _ in steps)
    end = next(index for index, (_, terminated, _) in enumerate(steps) if terminated)
    assert 0.7 < sum(reward for reward, _, _ in steps[: end + 1]) <= 1.0
    assert not any(info["is_success"] for _, _, info in steps[:end])


@pytest.mark.parametrize("skill", first("TurnOff"))
def test_it_is_seen_when_a_skill_is_over_and_not_before(skill: str) -> None:
    if skill in ("NavigateTo", "Season"):
        pytest.skip("drives are planned for all robots together, and what was seasoned does not show")
    env = make(skill).unwrapped
    env.reset(seed=5)
    manual, over = env._manual, []
    for wanted in manual.scripted():
        manual.command(in_room(wanted.q, wanted.frame), wanted.opening)
        over.append(manual.aim.over())
    assert manual.success and over[-1] and not any(over[: len(over) // 3])


def test_nothing_is_achieved_by_doing_nothing_and_sparse_rewards_say_so(faucet: Any) -> None:
    faucet.reset(seed=1)
    still = np.zeros(12, np.float32)
    still[-1] = 1.0
    steps = [faucet.step(still) for _ in range(20)]
    assert not any(reward or terminated or info["is_success"] for _, reward, terminated, _, info in steps)


def test_a_thing_that_is_only_touched_is_not_picked_up() -> None:
    env = make("PickUp", target="vegetable", layout="one_wall_large", style="modern_1").unwrapped
    steps = scripted(env, 2)
    end = next(index for index, (_, terminated, _) in enumerate(steps) if terminated)
    env.reset(seed=2)
    held = env._manual
    calls = []
    real = held._carried
    held._carried = lambda name: calls.append(real(name)) or real(name)
    for count, wanted in enumerate(held.scripted()):
        held.command(in_room(wanted.q, wanted.frame), wanted.opening)
        if count == end:
            break
    assert calls[0] is False and calls[-1] is True


def test_driving_to_the_station_is_success() -> None:
    env = make("NavigateTo", target="sink", layout="one_wall_large", style="modern_1", reward="progress").unwrapped
    env.reset(seed=1)
    manual, total = env._manual, 0.0
    for _ in range(600):
        goal, q = manual.sensing.goal, manual.q
        way = np.array([goal.x, goal.y, goal.yaw]) - q[:3]
        way[2] = np.remainder(way[2] + np.pi, 2 * np.pi) - np.pi
        q[:3] += np.clip(0.1 * way, -0.02, 0.02)
        reward, terminated, info = _as_step(env, q, 0.04)
        total += reward
        if terminated:
            break
    assert info["is_success"] and total == pytest.approx(1.0, abs=1e-6)


@pytest.mark.long
def test_pictures_come_with_the_state() -> None:
    env = make("TurnOn", target="faucet", obs="state+images", image_size=32, layout="one_wall_large").unwrapped
    observation, _ = env.reset(seed=1)
    assert env.observation_space.contains(observation)
    assert all(observation[name].shape == (32, 32, 3) for name in PICTURES)
    env.close()


@pytest.mark.long
def test_the_environment_for_lerobots_hub_is_what_lerobot_reads() -> None:
    file = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "lerobot" / "env.py"))
    file["OPTIONS"] |= {"image_size": 32, "max_episode_steps": 2}
    ((_, tasks),) = file["make_env"](n_envs=2, cfg=None).items()
    envs = tasks[0]
    observations, infos = envs.reset(seed=[1, 2])
    assert observations["agent_pos"].shape[0] == 2
    assert all(observations["pixels"][name].shape == (2, 32, 32, 3) for name in PICTURES)
    assert envs.call("task_description") == ("turn on faucet", "turn on faucet")
    assert envs.call("_max_episode_steps") == (2, 2)
    envs.action_space.seed(1)
    *_, infos = envs.step(envs.action_space.sample())
    assert not infos["is_success"].any() and "final_info" not in infos
    *_, infos = envs.step(envs.action_space.sample())
    assert infos["final_info"]["is_success"].tolist() == [False, False], "where LeRobot reads successes"
    envs.close()


def test_a_vessel_where_no_plain_start_has_one_is_put_there_by_the_robot() -> None:
    skill, case = SKILLS["place to"], "food in vessel on burner"

    def draw(kind: str, cases: tuple[str, ...] = (case,)) -> starts.Ready | None:
        chance, cell = np.random.default_rng(4), {"style": None, "layout": "one_wall_large", "body": "panda"}
        return starts._draw(skill, None, 5, chance, kind=kind, cases=cases, **cell)  # type: ignore[arg-type]

    ready = draw("paper")
    assert ready is not None and ready.case == case
    put = [step.target for step in ready.before if step.row.puts]
    assert put == ["stove"], "once, and never the food"
    plain = draw("paper", ("food on surface",))
    assert plain is None or not any(step.row.puts for step in plain.before)
