"""How episodes run and end, what robots are told, copies of environments and states."""

from __future__ import annotations

import copy
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import remac_env
from remac_env.errors import LifecycleError
from remac_env.oracle import solve
from remac_env.rules.skills import SKILLS
from remac_env.testing.play import play, random_legal, scripted

ROOT = Path(__file__).resolve().parents[2]


def make(task: str = "OpenCabinetPnP", **options: Any) -> Any:
    return remac_env.parallel_env(task, **({"backend": "symbolic"} | options))


def carry_out(env: Any, seed: int) -> list[Any]:
    """The turns of a shortest plan."""
    env.reset(seed=seed)
    plan = solve(env.start.scene, env.world, env.goal)
    assert plan is not None
    script = [{robot: env.vocabulary.encode(s.text) for robot, s in joint.items()} for joint in plan.rounds]
    return list(play(env, seed, scripted(script, otherwise=0), rounds=30))


@pytest.mark.few(3)
@pytest.mark.parametrize("task", remac_env.tasks())
def test_success_ends_the_episode_and_pays_every_robot(task: str) -> None:
    turns = carry_out(make(task), 2)
    assert [turn.ended for turn in turns[1:]] == [False] * (len(turns) - 2) + [True]
    assert set(turns[-1].rewards.values()) == {1.0}
    assert {info["end"] for info in turns[-1].infos.values()} == {"success"}
    assert all(info["success"] is False for turn in turns[:-1] for info in turn.infos.values())
    assert all(set(turn.rewards.values()) == {0.0} for turn in turns[1:-1])
    assert turns[-1].infos["robot_0"]["seconds"] > 0


def test_progress_rewards_sum_up_to_the_progress() -> None:
    env = make("DefrostInBowl", reward="progress")
    env.reset(seed=3)
    turns = carry_out(env, 3)
    assert env.progress == 1.0
    assert sum(turn.rewards["robot_1"] for turn in turns[1:]) == pytest.approx(1.0)


def test_truncated_after_max_rounds() -> None:
    turns = list(play(make(max_rounds=3), 0, scripted([], otherwise=0), rounds=30))
    assert [turn.truncations.get("robot_0") for turn in turns] == [None, False, False, True]
    assert turns[-1].infos["robot_0"]["end"] == "truncated" and not any(turns[-1].terminations.values())
    assert len(list(play(make(), 0, scripted([], otherwise=0), rounds=99))) == 31


def test_success_in_the_very_last_round_is_success() -> None:
    turns = carry_out(make(max_rounds=4), 0)
    assert turns[-1].number == 4 and turns[-1].infos["robot_0"]["success"]
    assert not any(turns[-1].truncations.values())


@pytest.mark.parametrize(
    ("script", "rounds"),
    [
        ([(1, 1)], 1),
        ([(1, 0), (0, 1)], 2),
        ([(1, 0), (2, 1), (1, 0)], 3),
        ([(1, -5), (0, 1)], 2),
    ],
    ids=["both at once", "one after the other", "taken back by acting", "an invalid token is waiting"],
)
def test_done_by_all_robots_ends_the_episode(script: list[tuple[int, int]], rounds: int) -> None:
    env = make()
    tokens = [{"robot_0": first, "robot_1": second} for first, second in script]
    turns = list(play(env, 0, scripted(tokens, otherwise=0), rounds=10))
    assert turns[-1].number == rounds
    assert set(turns[-1].terminations.values()) == {True} and turns[-1].infos["robot_0"]["end"] == "done"
    assert turns[-1].infos["robot_0"]["success"] is False


def test_one_robots_invalid_token_does_not_stop_the_other() -> None:
    env = make()
    env.reset(seed=0)
    go = env.vocabulary.encode("navigate to sink")
    _, _, _, _, infos = env.step({"robot_0": 10**12, "robot_1": go})
    assert infos["robot_0"]["outcome"]["reason"] == "invalid" and infos["robot_1"]["outcome"]["status"] == "success"
    assert env.world.robots["robot_1"].station == "sink"
    here = {*env.start.scene.fixtures, *env.start.scene.objects}
    absent = next(noun.name for noun in env.vocabulary.nouns if noun.name not in here)
    _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(f"navigate to {absent}"), "robot_1": 0})
    assert infos["robot_0"]["outcome"]["reason"] == "invalid"


# -- what robots are told -------------------------------------------------------------------------------------------


def test_feedback_says_why_only_when_asked_to() -> None:
    for feedback, told in (("status", False), ("reason", True)):
        env = make(feedback=feedback)
        env.reset(seed=0)
        _, _, _, _, infos = env.step(dict.fromkeys(env.agents, env.vocabulary.encode("open cabinet door")))
        assert infos["robot_0"]["outcome"]["reason"] == "not_at_station"
        assert ("not_at_station" in infos["robot_0"]["text"]) is told
        assert "failed" in infos["robot_0"]["text"]


def test_states_are_told_only_when_asked_to() -> None:
    _, infos = make(text="states", starts="mixed").reset(seed=1)
    assert "The cabinet door is" in infos["robot_0"]["text"] and "robot_1 stands at aside" in infos["robot_0"]["text"]


def test_each_robot_is_told_who_it_is() -> None:
    _, infos = make().reset(seed=1)
    assert infos["robot_1"]["text"].startswith("You are robot_1.")
    assert infos["robot_0"]["text"].replace("You are robot_0", "You are robot_1") == infos["robot_1"]["text"]


@pytest.mark.parametrize("wording", [1, 2, 3])
def test_wordings(wording: int) -> None:
    _, infos = make("HeatOnStove", wording=wording).reset(seed=1)
    told = ("place the pan onto the stove, pick up", "the pan has to hold it there", "heat the vegetable on the stove")
    assert told[wording - 1] in infos["robot_0"]["goal"]
    assert infos["robot_0"]["goal"] in infos["robot_0"]["text"]


def test_changing_what_was_told_changes_nothing() -> None:
    env, fresh = make(), make()
    observations, infos = env.reset(seed=0)
    fresh.reset(seed=0)
    for seen in observations.values():
        for array in seen.values():
            array[...] = 0
    for info in infos.values():
        info["commands"].clear()
        info["episode"].clear()
        info["verbs"]["fly"] = ()
        info["world"] = None
    go = dict.fromkeys(env.agents, env.vocabulary.encode("navigate aside"))
    mine, theirs = env.step(go), fresh.step(go)
    assert mine[4] == theirs[4] and mine[1:4] == theirs[1:4]
    assert all(np.array_equal(mine[0][n][k], v) for n, seen in theirs[0].items() for k, v in seen.items())


def test_observations_show_the_own_robot_first() -> None:
    env = make()
    observations, _ = env.reset(seed=0)
    go = {"robot_0": env.vocabulary.encode("navigate to sink"), "robot_1": 0}
    observations = env.step(go)[0]
    swapped = make()
    swapped.reset(seed=0)
    mirror = swapped.step({"robot_0": 0, "robot_1": go["robot_0"]})[0]
    assert np.array_equal(observations["robot_0"]["observation"], mirror["robot_1"]["observation"])
    assert not np.array_equal(observations["robot_0"]["observation"], observations["robot_1"]["observation"])
    assert np.array_equal(env.state(), np.concatenate([s["observation"] for s in observations.values()]))


def test_different_worlds_look_different() -> None:
    """Up to slots, the vector tells worlds apart: nothing that a policy needs is missing from it."""
    env, seen = make("HeatOnStove", starts="mixed", robots=1), {}
    for seed in range(20):
        for turn in play(env, seed, random_legal(seed, env.vocabulary), rounds=15):
            info = turn.infos["robot_0"]
            key = turn.observations["robot_0"]["observation"].tobytes()
            assert seen.setdefault(key, facts(info["world"])) == facts(info["world"])
    assert len(seen) > 100


def facts(world: Any) -> Any:
    """What of a world must be told apart: everything but the very slots and burners."""
    things = sorted((name, item.place.relation, *sorted(item.marks)) for name, item in world.objects.items())
    fixtures = sorted((name, str(state.door), bool(state.on)) for name, state in world.fixtures.items())
    return [(robot.holding, robot.station) for robot in world.robots.values()], things, fixtures


def test_slips_are_seeded_rare_and_only_of_what_was_accepted() -> None:
    env = make(failure_rate=0.3, max_rounds=1000)
    reasons = []
    for turn in play(env, 0, scripted([], otherwise=env.vocabulary.encode("navigate aside")), rounds=300):
        reasons += [info["outcome"]["reason"] for info in turn.infos.values() if info["outcome"]]
    assert 0.2 < reasons.count("slipped") / len(reasons) < 0.4
    refused = env.vocabulary.encode("place to counter")
    turns = play(env, 0, scripted([], otherwise=refused), rounds=50)
    assert {info["outcome"]["reason"] for turn in turns for info in turn.infos.values() if info["outcome"]} == {
        "hands_empty"
    }
    always = make(failure_rate=1.0)
    always.reset(seed=0)
    assert always.step({"robot_0": 0, "robot_1": 2})[4]["robot_0"]["outcome"]["status"] == "success"


# -- copies and other processes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("failure_rate", "commands", "reason", "takes_time"),
    [
        (1.0, ["navigate to microwave"], "slipped", True),
        (0.0, ["navigate to microwave"], "", True),
        (0.0, ["close cabinet door"], "not_at_station", False),
        (0.0, ["navigate to microwave", "close microwave door"], "already_done", False),
        (0.0, ["navigate to microwave", "open microwave door", "turn on microwave"], "blocked", True),
        (0.0, ["navigate to vegetable", "pick up vegetable", "navigate to cabinet", "place to cabinet"],
         "door_closed", True),
        (0.0, ["navigate to vegetable", "pick up vegetable", "navigate to cabinet", "open cabinet door"],
         "dropped", True),
    ],
)  # fmt: skip
def test_what_is_tried_takes_its_time_and_what_is_refused_takes_none(
    failure_rate: float, commands: list[str], reason: str, takes_time: bool
) -> None:
    env = remac_env.parallel_env("OpenCabinetPnP", robots=1, backend="symbolic", failure_rate=failure_rate)
    env.reset(seed=0)
    for command in commands:
        _, _, _, _, infos = env.step({"robot_0": env.vocabulary.encode(command)})
    outcome, nominal = infos["robot_0"]["outcome"], SKILLS[env.vocabulary.parse(commands[-1]).skill].seconds
    assert (outcome["reason"], outcome["seconds"]) == (reason, nominal if takes_time else 0.0)


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copied_environment_goes_on_by_itself(duplicate: Any) -> None:
    env = make("HeatOnStove", starts="mixed", failure_rate=0.2)
    env.reset(seed=3)
    env.step(dict.fromkeys(env.agents, 2))
    other = duplicate(env)
    for _ in range(5):
        step = dict.fromkeys(env.agents, env.vocabulary.encode("navigate to counter"))
        assert env.step(step)[4] == other.step(step)[4]
    env.close()
    assert other.step(dict.fromkeys(other.agents, 0))[4]["robot_0"]["round"] == 7
    with pytest.raises(LifecycleError):
        env.step({})


def test_a_world_from_another_process_is_equal_and_hashes_equal(tmp_path: Path) -> None:
    """Strings hash differently in each process, so a hash that was kept must not travel with the state."""
    file = tmp_path / "world.bin"
    code = (
        "import pickle, sys, remac_env\n"
        "env = remac_env.parallel_env('HeatOnStove', backend='symbolic', starts='mixed')\n"
        "env.reset(seed=4)\n"
        "things = (env.world, env.start.scene)\n"
        "hash(things)\n"
        f"open({str(file)!r}, 'wb').write(pickle.dumps(things))\n"
    )
    for hashes in ("1", "2"):
        environ = os.environ | {"PYTHONHASHSEED": hashes, "PYTHONPATH": str(ROOT)}
        subprocess.run([sys.executable, "-c", code], check=True, env=environ, cwd=tmp_path)
        env = make("HeatOnStove", starts="mixed")
        env.reset(seed=4)
        hash(env.world)
        world, scene = pickle.loads(file.read_bytes())
        assert world == env.world and hash(world) == hash(env.world) and world in {env.world}
        assert scene == env.start.scene and hash(scene) == hash(env.start.scene)


def test_many_environments_at_once_do_not_disturb_one_another() -> None:
    alone = [turn.infos["robot_0"]["world"] for turn in play(make(), 5, random_legal(5, make().vocabulary), rounds=10)]
    envs = [make() for _ in range(20)]
    for seed, env in enumerate(envs):
        env.reset(seed=seed)
    walks = [play(env, 5, random_legal(5, env.vocabulary), rounds=10) for env in envs]
    for turns in zip(*walks, strict=True):
        assert {turn.infos["robot_0"]["world"] for turn in turns} == {alone[turns[0].number]}
