"""What a model's thinking costs under the event clock: by its tokens, at each rate, and again from a cassette."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from agent_kitchens import suite_kitchen
from chaos_server import Asked, ChaosServer, says
from scripted_model import TASK, Pictured, ScriptedModel, prompt_of

import remac_agents

TOKENS = {"react_step": 540, "planner": 1450, "reflector": 500, "handover": 1750}
"""What reasoning models write for each question; 145 for any other."""

RATE = 50_000.0
"""Tokens a second of the server: a thousand times as quick as a usual one."""


class Writer(ScriptedModel):
    """Says how many tokens it wrote, and takes its time for them."""

    def act(self, connection: socket.socket, asked: Asked) -> None:
        """Answer a request."""
        messages = asked.body["messages"]
        name, told = prompt_of(messages[0]["content"]), messages[-1]["content"]
        user = told if isinstance(told, str) else told[0]["text"]
        self.heard.append((name, user))
        tokens = TOKENS.get(name, 145)
        time.sleep(tokens / RATE)
        usage = {"prompt_tokens": 900, "completion_tokens": tokens, "total_tokens": 900 + tokens}
        says(self.text(name, user), usage=usage)(connection, asked)


@contextmanager
def writer(think: str) -> Iterator[Writer]:
    kitchen = {"robots": 2, "layout": "one_wall_large", "clock": "events", "think": think, "max_seconds": 6000.0}
    env = Pictured(suite_kitchen(TASK, **kitchen))
    _, infos = env.reset(seed=3)
    env.infos_commands = tuple(next(iter(infos.values()))["commands"])
    with ChaosServer() as server:
        model = Writer(env, server)
        server.script = [model.act]
        yield model


def play(env: Any, agent: remac_agents.Agent) -> tuple[bool, float, Any]:
    """Success, makespan and timeline of an episode in which thinking costs what it does."""
    obs, infos = env.reset(seed=3)
    agent.reset(obs, infos)
    while env.agents:
        tokens = agent.act(obs, infos)
        for robot, thought in agent.thoughts().items():
            env.note_thought(robot, thought)
        obs, _, _, _, infos = env.step(tokens)
    agent.close_episode(obs, infos)
    told = next(iter(infos.values()))
    return told["success"], told["seconds"], env.timeline


def played(method: str, think: str, folder: Path) -> list[tuple[bool, float, Any]]:
    """The iterations of a method, once with a model and once from the cassette, which come out the same."""
    many, path = 3 if method == "REMAC" else 1, folder / f"{method}-{think.replace(':', '-')}.jsonl"
    with writer(think) as model:
        ask = {"model": "custom:m", "base_url": model.server.url, "cassette": path}
        agent = remac_agents.make(method, **ask)
        first = [play(model.env, agent) for _ in range(many)]
        asked, agent = len(model.heard), remac_agents.make(method, **ask, replay=True)
        assert [play(model.env, agent) for _ in range(many)] == first and len(model.heard) == asked
    assert first[-1][0]
    return first


@pytest.mark.long
@pytest.mark.parametrize("method", ["REACT", "CC", "REMAC"])
def test_thinking_costs_in_proportion_to_what_is_written(method: str, tmp_path: Path) -> None:
    rates = (0, 10, 30, 100, 300)
    free, *others = (played(method, f"tokens:{rate}", tmp_path)[-1][1] for rate in rates)
    costs = [seconds - free for seconds in others]
    assert costs[0] > 0 and costs == pytest.approx([rate / 10 * costs[0] for rate in rates[1:]])


@pytest.mark.parametrize("method", [pytest.param(name, marks=pytest.mark.long) for name in ("CC", "REMAC")] + ["REACT"])
def test_thinking_costs_as_long_as_it_took(method: str, tmp_path: Path) -> None:
    _, _, timeline = played(method, "recorded", tmp_path)[-1]
    thoughts = [span.ended - span.began for span in timeline if span.kind == "thought"]
    assert thoughts and all(thought >= 145 / RATE for thought in thoughts)
