"""Hostile values at the agents' doors: options, what the kitchen is said to have told, and answers of roles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hostile import ODD, meet

import remac_agents
import remac_env
from remac_agents.options import AgentOptions
from remac_agents.plan import Commands, PlanError, read_plan
from remac_env.option_rows import rows


@pytest.mark.parametrize("name", list(rows(AgentOptions)))
def test_options(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # some of the paths can be written
    values = [value for value in ODD if not (callable(value) and rows(AgentOptions)[name].group == "role")]
    meet(lambda value: remac_agents.make("RE", **{name: value}), about=name, values=values)


def test_methods() -> None:
    meet(remac_agents.make, about="method")


def test_what_the_kitchen_is_said_to_have_told() -> None:
    env: Any = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic")
    obs, infos = env.reset(seed=1)
    agent = remac_agents.make("CC")
    meet(lambda value: agent.reset(value, infos), about="observations")
    meet(lambda value: agent.reset(obs, value), about="infos")
    meet(lambda value: agent.reset({"robot_0": value}, infos), about="observations")
    meet(lambda value: agent.reset(obs, {"robot_0": value}), about="infos")
    agent.reset(obs, infos)
    meet(lambda value: agent.act(obs, value), about="infos")
    meet(lambda value: agent.close_episode(obs, value), about="infos")


@pytest.mark.parametrize("answer", [np.array(1), np.array("wait"), np.array(None, dtype=object), np.ma.masked])
def test_an_answer_that_only_says_that_it_can_be_walked_through(answer: Any) -> None:
    env: Any = remac_env.parallel_env("HeatOnStove", robots=1, backend="symbolic")
    _, infos = env.reset(seed=1)
    assert isinstance(read_plan(answer, Commands(infos["robot_0"]["commands"]), ("robot_0",), "robot_0"), PlanError)
