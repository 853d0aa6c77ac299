"""Quirks in physics: each in a kitchen of its own, against the table, without it, and how the mechanisms are made."""

from __future__ import annotations

import inspect
from dataclasses import replace

import pytest
from quirk_sheet import load, play, task_of

import remac_env
from remac_env.backends.physics import quirks
from remac_env.errors import OptionError
from remac_env.generator import make
from remac_env.rules.facts import Quirk
from remac_env.rules.quirks import QUIRKS
from remac_env.state import Place
from remac_env.tasks.setup import Setup

TRIALS = load()


def test_every_kind_has_a_trial_and_something_in_physics() -> None:
    assert set(TRIALS) == {name for name, row in QUIRKS.items() if not row.across}
    for name, row in ((name, row) for name, row in QUIRKS.items() if not row.across):
        assert (name in quirks.ROWS) != (row.fills or row.marks_alone), name


def test_mechanisms_give_forces_and_never_put_anything_anywhere() -> None:
    modules = (quirks.doors, quirks.switches, quirks.objects, inspect.getmodule(quirks.Surroundings))
    for module in modules:
        source = inspect.getsource(module)  # type: ignore[arg-type]
        for word in ("qpos[", "qvel["):
            assert not [line for line in source.splitlines() if line.strip().startswith(f"data.{word}")]
            assert f"{word}self._dof] =" not in source and f"{word}self._qpos] =" not in source
        assert ".place(" not in source and ".put(" not in source and "eq_active" not in source


@pytest.mark.parametrize("kind", TRIALS)
def test_trials_by_the_table(kind: str) -> None:
    shown = play(kind, TRIALS[kind], backend="symbolic")
    assert not shown.held and shown.held_then, shown.told


@pytest.mark.long
@pytest.mark.parametrize("kind", TRIALS)
def test_trials_in_physics_as_by_the_table(kind: str) -> None:
    shown = play(kind, TRIALS[kind])
    assert not shown.held and shown.held_then, shown.told
    assert shown.told == play(kind, TRIALS[kind], backend="symbolic").told


@pytest.mark.long
@pytest.mark.parametrize("kind", ["jammed door", "stuck object", "cold burner", "hot vessel", "falling door"])
def test_without_the_quirk_the_same_commands_do_it(kind: str) -> None:
    assert play(kind, TRIALS[kind], quirky=False).held


@pytest.mark.long
def test_one_subtask_pulls_once_at_a_door_that_jams() -> None:
    """One that found no way beside another at work went back to the door, which had given way by then."""
    env = remac_env.parallel_env(make(grade=1, seed=192001, template="physics", quirks=2, robots=2).spec, robots=2)
    env.reset(seed=192001)
    for pair in (
        ("navigate to carrot", "navigate aside"), ("navigate to counter", "navigate to stove"),
        ("navigate to stove", "navigate to carrot"), ("wait", "pick up carrot"), ("navigate to cabinet", "wait"),
        ("navigate aside", "navigate to microwave"), ("wait", "turn on microwave"), ("wait", "wait"),
        ("navigate to cabinet", "wait"), ("open cabinet door", "close microwave door"),
    ):
        infos = env.step({name: env.vocabulary.encode(text) for name, text in zip(env.agents, pair, strict=True)})[4]
    assert infos["robot_0"]["outcome"]["reason"] == "blocked" and env.world.fixtures["cabinet"].door == "ajar"


def test_a_floor_plan_that_physics_lacks_is_refused() -> None:
    galley = Quirk("narrow galley", "cabinet", "counter")
    spec = replace(task_of("stuck object", TRIALS["stuck object"]), quirks=(galley,))
    with pytest.raises(OptionError, match="narrow galley"):
        remac_env.parallel_env(spec, robots=2)


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1])
def test_robots_take_turns_at_a_door_that_falls_shut(seed: int) -> None:
    """One opens it, for which its base moves away from its station, and leaves while the other comes."""
    task = make(grade=1, seed=seed, template="fruit into the cabinet that falls shut", robots=2)
    env = remac_env.parallel_env(task.spec, robots=2)
    env.reset(seed=0)
    for joint in task.plan.rounds:
        env.step({name: env.vocabulary.encode(subtask.text) for name, subtask in joint.items()})
    assert env.goal.holds(env.start.scene, env.world)


def test_a_full_shelf_with_something_in_it_is_refused() -> None:
    spec = task_of("full shelf", TRIALS["full shelf"])
    setup = Setup({"apple": "apple"}, {"apple": Place("slot", "cabinet.0")})
    crowded = replace(spec, setup=setup)
    with pytest.raises(OptionError, match="the apple is in the cabinet"):
        remac_env.parallel_env(crowded, robots=1)


@pytest.mark.long
def test_a_quirk_that_has_nothing_to_do_changes_no_motion() -> None:
    trial = TRIALS["stuck object"]
    plain = task_of("stuck object", trial, quirky=False)
    other = replace(plain, quirks=(Quirk("dead switch", "microwave"), Quirk("jammed door", "cupboard")))
    ends = []
    for spec in (plain, other):
        env = remac_env.parallel_env(spec, robots=1)
        env.reset(seed=1)
        for text in trial.tries:
            env.step({"robot_0": env.vocabulary.encode(text)})
        ends.append(env._backend.positions().tolist())  # type: ignore[attr-defined]
    assert ends[0] == ends[1]


def test_what_runs_only_shut_goes_off_when_its_door_opens_whatever_turns_it_on() -> None:
    told = {}
    for backend in ("symbolic", "physics"):
        env = remac_env.parallel_env("OpenCabinetPnP", robots=1, layout="rich_u_shaped", backend=backend)
        env.reset(seed=1)
        told[backend] = []
        for text in ("navigate to oven", "turn on oven", "open oven door", "turn on oven", "close oven door"):
            infos = env.step({"robot_0": env.vocabulary.encode(text)})[4]
            oven = env.world.fixtures["oven"]
            told[backend].append((infos["robot_0"]["outcome"]["reason"], oven.door, set(oven.on)))
    assert told["physics"] == told["symbolic"]
    assert told["physics"][1:] == [
        ("", "closed", {"oven"}), ("", "open", set()), ("blocked", "open", set()), ("", "closed", set())
    ]


@pytest.mark.long
def test_who_has_to_stand_elsewhere_may_leave_in_the_round_in_which_a_switch_is_turned_on() -> None:
    """A round is judged by the world that it begins in: by the table, and in physics too."""
    env = remac_env.parallel_env(make(grade=2, seed=194100, template="water for two robots", robots=2).spec, robots=2)
    told = []
    env.reset(seed=194100)
    for pair in (("navigate to faucet", "navigate to oven"), ("turn on faucet", "navigate aside")):
        infos = env.step({name: env.vocabulary.encode(text) for name, text in zip(env.agents, pair, strict=True)})[4]
        told += [info["outcome"]["reason"] for info in infos.values()]
    assert told == ["", "", "", ""] and env.world.fixtures["faucet"].on
    for text in ("turn off faucet", "turn on faucet"):
        env.step({"robot_0": env.vocabulary.encode(text), "robot_1": env.vocabulary.encode("wait")})
    assert not env.world.fixtures["faucet"].on
