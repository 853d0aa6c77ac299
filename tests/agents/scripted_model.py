"""A language model for tests: a real endpoint on loopback whose answers follow a script and the kitchen's truth."""

from __future__ import annotations

import json
import re
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from agent_kitchens import play, suite_kitchen
from chaos_server import Asked, ChaosServer, says

import remac_agents
from remac_agents.conditions.rule import RuleConditions
from remac_agents.plan import Commands
from remac_agents.prompting.prompt import load, names
from remac_agents.roles import View
from remac_env.rules.scene import public_scene
from remac_env.rules.sentences import read_condition

PICTURES = {name: np.full((8, 8, 3), shade, np.uint8) for shade, name in enumerate(("front", "wrist", "side"))}
"""Stand-ins for what cameras see: the scripted model looks at the world instead."""

TASK = "OpenMicrowavePnP"
NAIVE = "navigate to vegetable, pick up vegetable, navigate to microwave, place to microwave"
DETOUR = "navigate to counter, place to counter, navigate to microwave, open microwave door"
REPAIRED = f"{DETOUR}, {NAIVE}"
RIGHT = f"navigate to microwave, open microwave door, {NAIVE}"


def prompt_of(system: str) -> str:
    """Which prompt a system message comes from; its beginning tells."""
    return next(name for name in names() if load(name).system[:150] == system[:150])


@dataclass
class ScriptedModel:
    """Plays every role well, but for the naive plan that it makes until it has learnt better.

    `answers` replaces the text of a prompt's answers: a text, or a function of the user's message.
    """

    env: Any
    server: ChaosServer
    answers: dict[str, str | Callable[[str], str]] = field(default_factory=dict)
    heard: list[tuple[str, str]] = field(default_factory=list)
    plan_before: str = NAIVE

    def act(self, connection: socket.socket, asked: Asked) -> None:
        """Answer a request."""
        messages = asked.body["messages"]
        name = prompt_of(messages[0]["content"])
        told = messages[-1]["content"]
        user = told if isinstance(told, str) else told[0]["text"]
        self.heard.append((name, user))
        says(self.text(name, user))(connection, asked)

    def text(self, name: str, user: str) -> str:
        """What the model says."""
        scripted = self.answers.get(name)
        if scripted is not None:
            return scripted if isinstance(scripted, str) else scripted(user)
        return str(getattr(self, f"_{name}")(user))

    def _planner(self, user: str) -> str:
        return f"Plan: [{RIGHT if 'Lessons' in user else self.plan_before}]"

    def _planner_step(self, user: str) -> str:
        if [name for name, _ in self.heard] == ["planner_step"]:
            return "Plan: [pick up vegetable]"
        steps = [*RIGHT.split(", "), "done"]
        return f"Plan: [{steps[user.count(': worked')]}]"

    def _react_step(self, user: str) -> str:
        steps = [*RIGHT.split(", "), "done"] if "Robot: robot_0" in user else ["done"]
        return f"Thought: it is my turn.\nPlan: [{steps[min(user.count(': worked'), len(steps) - 1)]}]"

    def _planner_correct(self, user: str) -> str:
        return f"<think>what now?</think>Plan: [{REPAIRED}]"

    def _smart_llm_decompose(self, user: str) -> str:
        steps = RIGHT.split(", ")
        tasks = [
            {"id": "open", "steps": [*steps[:2], "navigate aside"], "skills": ["open door"], "after": []},
            {"id": "bring", "steps": steps[2:], "skills": ["pick up", "place to"], "after": []},
        ]
        return "```json\n" + json.dumps({"subtasks": tasks}) + "\n```"

    def _smart_llm_allocate(self, user: str) -> str:
        robots = re.findall(r"^(\w+): \[", user, re.M)
        team = dict(zip(("open", "bring"), (*robots, *robots), strict=False))
        return json.dumps({task: {"robots": [robot], "reason": "it is free"} for task, robot in team.items()})

    def _handover(self, user: str) -> str:
        lead, helper = re.findall(r"Write the rows of (\w+) and (\w+)", user)[0]
        steps = RIGHT.split(", ")
        return f"{lead}: [{', '.join(steps[2:])}]\n{helper}: [{', '.join(steps[:2])}, navigate aside]"

    def _conditions(self, user: str, verb: str, method: str) -> str:
        robot, command, held = re.findall(rf'^(\w+) {verb} "(.+?)", .*held? (?:the )?(.+?):$', user, re.M)[-1]
        commands = Commands(self.env.infos_commands)
        view = View("", public_scene(self.env.start.scene), {robot: None if held == "nothing" else held})
        found = getattr(RuleConditions(), method)(commands[command], robot, view)
        return json.dumps({"conditions": [condition.sentence for condition in found]})

    def _conditions_before(self, user: str) -> str:
        return self._conditions(user.replace("gripper holds", "gripper held"), "is to run", "before")

    def _conditions_after(self, user: str) -> str:
        return self._conditions(user, "has run", "after")

    def _checker_known(self, user: str) -> str:
        return self._checker_seen(user)

    def _checker_ran(self, user: str) -> str:
        return self._checker_seen(user)

    def _checker_seen(self, user: str) -> str:
        sentences = re.findall(r"^\d+\. (.*)$", re.split(r"Sentences:|Is it right\?", user)[-1], re.M)
        conditions = [read_condition(sentence, public_scene(self.env.start.scene)) for sentence in sentences]
        scene, world = self.env.start.scene, self.env.world
        return json.dumps({"verdicts": [c is None or c.holds(scene, world) for c in conditions]})

    def _analysis(self, user: str) -> str:
        fetch = "navigate to vegetable, pick up vegetable, navigate to microwave"
        return json.dumps({"reason": "the door is shut", "next_steps": f"{DETOUR}, {fetch}".split(", ")})

    def _adjustment(self, user: str) -> str:
        return f"The new plan:\n\nPlan: [{REPAIRED}]"

    def _reflector(self, user: str) -> str:
        return json.dumps({"reason": "a full hand opens no door", "avoid": "open it first", "remedy": "put it down"})

    def _summary(self, user: str) -> str:
        events, subgoals = user.split("Subgoals:")
        lines = {"events": events, "subgoals": subgoals}
        told = {name: re.findall(r"^\d+\. (.*)$", text, re.M) for name, text in lines.items()}
        return "Here it is:\n```json\n" + json.dumps(told) + "\n```"

    def _explanation(self, user: str) -> str:
        return json.dumps({"reason": "the door was shut", "step": 4})


class Pictured:
    """A kitchen with stand-ins for pictures in its observations, where it draws none itself: that takes no time."""

    def __init__(self, env: Any) -> None:
        self._env, self._looks = env, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._env, name)

    def reset(self, **options: Any) -> Any:
        """As the kitchen's."""
        obs, infos = self._env.reset(**options)
        self._looks = 0
        return self._with_pictures(obs), infos

    def step(self, actions: Any) -> Any:
        """As the kitchen's."""
        obs, *rest = self._env.step(actions)
        return self._with_pictures(obs), *rest

    def _with_pictures(self, obs: Any) -> Any:
        self._looks += 1
        pictures = {name: picture + np.uint8(self._looks % 200) for name, picture in PICTURES.items()}
        return {robot: {**pictures, **seen} for robot, seen in obs.items()}


@contextmanager
def scripted(task: str = TASK, *, pictures: bool = True, **options: Any) -> Iterator[ScriptedModel]:
    """A kitchen, and a model that knows it."""
    env = suite_kitchen(task, **options)
    env = Pictured(env) if pictures else env
    _, infos = env.reset(seed=3)
    env.infos_commands = tuple(next(iter(infos.values()))["commands"])
    with ChaosServer() as server:
        model = ScriptedModel(env, server)
        server.script = [model.act]
        yield model


def agent_of(model: ScriptedModel, method: str, **options: Any) -> remac_agents.Agent:
    """An agent whose roles are all this model."""
    return remac_agents.make(method, model="custom:scripted", base_url=model.server.url, **options)


def run(model: ScriptedModel, method: str, **options: Any) -> remac_agents.EpisodeReport:
    """One episode."""
    return play(model.env, agent_of(model, method, **options))

