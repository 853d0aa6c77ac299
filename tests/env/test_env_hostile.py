"""Hostile values at every door: refused by an error of ours that says what is valid, in few words; nothing changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium
import pytest
from hostile import NEVER, meet

import remac_env
from remac_env.errors import RemacError
from remac_env.option_rows import rows
from remac_env.options import Options
from remac_env.tasks.compound import AnyOf, Before, Count, ForAll, Not
from remac_env.tasks.goals import All, DoorIs, Inside, Marked, Released, SwitchedOn
from remac_env.tasks.spec import Role, TaskSpec
from remac_env.thinking import Thought


@pytest.mark.parametrize("name", list(rows(Options)))
def test_options(name: str) -> None:
    meet(lambda value: remac_env.parallel_env("HeatOnStove", **{"backend": "symbolic", name: value}), about=name[:5])


@pytest.mark.parametrize("name", ["grade", "seed", "template", "quirks", "knowledge", "robots"])
def test_generating(name: str) -> None:
    meet(lambda value: remac_env.generate(**{"grade": 1, "seed": 3, name: value}), about=name)


@pytest.mark.parametrize("clock", ["rounds", "events"])
def test_playing(clock: str) -> None:
    env: Any = remac_env.parallel_env("HeatOnStove", backend="symbolic", clock=clock)
    env.reset(seed=1)
    before = env.world
    meet(lambda value: remac_env.parallel_env(value, backend="symbolic"), about="task")
    meet(lambda value: env.reset(seed=value), about="seed", values=NEVER)
    meet(lambda value: env.reset(seed=1, options=value), about="")
    meet(lambda value: env.reset(seed=1, options={"style": value}), about="style")
    meet(env.step, about="actions")
    meet(lambda value: env.step({"robot_0": value, "robot_1": 0}), about="robot_0", values=NEVER)
    for door in (env.action_mask, env.observation_space, env.action_space):
        meet(door, about="robot")
    if clock == "events":
        meet(lambda value: env.note_thought(value, Thought()), about="asked")
        meet(lambda value: env.note_thought("robot_0", value), about="thought")
    assert env.world == before


def test_playing_as_others_do() -> None:
    joint: Any = gymnasium.make("RemacKitchen-HeatOnStove-v0", backend="symbolic", robots=2).unwrapped
    turns: Any = remac_env.env("HeatOnStove", backend="symbolic")
    joint.reset(seed=1)
    turns.reset(seed=1)
    meet(joint.step, values=NEVER)
    meet(lambda value: joint.reset(seed=value), about="seed")
    meet(turns.observe, about="robot")
    meet(turns.step, about="robot_0", values=NEVER)


@pytest.mark.long
def test_one_skill() -> None:
    from remac_env.lowlevel.env import SkillEnv

    meet(lambda value: SkillEnv(value), about="skill")
    env = SkillEnv("OpenDoor")
    env.reset(seed=1)
    meet(env.step, about="action")
    meet(lambda value: env.reset(seed=value), about="seed", values=NEVER)


def mine(**fields: Any) -> TaskSpec:
    """A task of one's own."""
    told: dict[str, Any] = {
        "name": "Mine",
        "wordings": ("put the {v} into the cabinet",) * 3,
        "goal": All(Inside("{v}", "cabinet"), Released("{v}")),
        "roles": (Role("v", ("vegetable",)),),
        "fixtures": ("cabinet",),
    }
    return TaskSpec(**{**told, **fields})


@pytest.mark.parametrize("name", [name for name in TaskSpec.__dataclass_fields__ if name != "generated"])
def test_tasks_of_ones_own(name: str) -> None:
    meet(lambda value: remac_env.parallel_env(mine(**{name: value}), backend="symbolic"))
    meet(lambda value: remac_env.parallel_env(mine(**{name: (value,)}), backend="symbolic"))


@pytest.mark.parametrize("name", list(Role.__dataclass_fields__))
def test_roles(name: str) -> None:
    meet(lambda value: Role(**{"name": "v", "nouns": ("vegetable",), name: value}), about=name)


OPEN = Released("apple")
GOALS: dict[str, Callable[[Any], Any]] = {
    "name": lambda value: Inside(value, "cabinet"),
    "container": lambda value: Inside("apple", value),
    "only_on": lambda value: Inside("apple", "cabinet", only_on=value),
    "fixture": lambda value: SwitchedOn(value),
    "door": lambda value: DoorIs("cabinet", value),
    "mark": lambda value: Marked("apple", value),
    "All: goals": lambda value: All(OPEN, value),
    "AnyOf: goals": lambda value: AnyOf(value, OPEN),
    "goal": lambda value: Not(value),
    "kind": lambda value: ForAll(value, OPEN, ("apple",)),
    "each": lambda value: ForAll("fruit", value, ("apple",)),
    "among": lambda value: Count("fruit", OPEN, value, least=1),
    "least": lambda value: Count("fruit", OPEN, ("apple",), least=value),
    "first": lambda value: Before("apple", value, "heated"),
}


@pytest.mark.parametrize("name", GOALS)
def test_goals(name: str) -> None:
    meet(GOALS[name], about=name)


def test_a_task_that_nobody_registered_is_looked_at_before_it_is_played() -> None:
    for spec in (mine(goal=Inside("apple", "cabinet")), mine(goal=SwitchedOn("nothing")), mine(fixtures=("nothing",))):
        with pytest.raises(RemacError, match="valid: "):
            remac_env.parallel_env(spec, backend="symbolic")
    remac_env.parallel_env(mine(roles=[Role("v", ("vegetable",))]), backend="symbolic").reset(seed=1)
