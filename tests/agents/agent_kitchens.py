"""Kitchens for tests of agents: the suite's and made-up ones whose nouns no code knows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import remac_env.registry as registry
from remac_agents import Agent, EpisodeReport
from remac_agents.roles import PlanRequest
from remac_env.rules.facts import FixtureFacts, ObjectFacts, Rules, SlotFacts
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import Subtask
from remac_env.state import FixtureState, FrozenMap, ObjectState, Place, RobotState, WorldState
from remac_env.tasks.goals import Goal
from remac_env.vocabulary import Noun, Vocabulary


def suite_kitchen(task: str, **options: Any) -> Any:
    """A task of the suite on the symbolic backend."""
    return registry.parallel_env(task, **{"robots": 2, "backend": "symbolic", **options})


def play(env: Any, agent: Agent, *, seed: int = 3, most: int = 100) -> EpisodeReport:
    """One episode by the ordinary loop."""
    obs, infos = env.reset(seed=seed)
    agent.reset(obs, infos)
    rounds = 0
    while env.agents:
        obs, _, _, _, infos = env.step(agent.act(obs, infos))
        rounds += 1
        assert rounds <= most, "the episode does not end"
    agent.close_episode(obs, infos)
    return agent.report()


@dataclass
class MadeUpKitchen:
    """A little ParallelEnv around rounds.transition: made of facts alone."""

    name: str
    sentence: str
    goal: Goal
    fixtures: Mapping[str, FixtureFacts]
    objects: Mapping[str, ObjectFacts]
    places: Mapping[str, str]
    verbs: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    robots: tuple[str, ...] = ("robot_0", "robot_1")
    slot_stations: Mapping[str, str] = field(default_factory=dict)
    max_rounds: int = 40

    def __post_init__(self) -> None:
        """Facts, vocabulary and start follow from the fields."""
        slots = {
            slot: SlotFacts(slot, name, self.slot_stations.get(slot, facts.station))
            for name, facts in self.fixtures.items()
            for slot in facts.slots
        }
        self.scene = Rules(
            self.robots, FrozenMap(self.fixtures), FrozenMap(slots), FrozenMap(self.objects), frozenset()
        )
        vocabulary = Vocabulary(
            [*map(_fixture_noun, self.fixtures.values()), *self._object_nouns()], version=1
        )
        self.vocabulary = vocabulary
        self.commands = {text: vocabulary.encode(text) for text in vocabulary.commands(self.scene)}
        self.start = WorldState(
            FrozenMap({robot: RobotState() for robot in self.robots}),
            FrozenMap({name: ObjectState(Place("slot", slot)) for name, slot in self.places.items()}),
            FrozenMap({n: FixtureState("closed" if f.door else None) for n, f in self.fixtures.items()}),
        )
        self.agents: list[str] = []

    def reset(self, seed: int = 0) -> tuple[dict[str, Any], dict[str, Any]]:
        """The one start there is."""
        self.world, self.rounds, self.seed = self.start, 0, seed
        self.agents = list(self.robots)
        self.outcomes: dict[str, Any] = {}
        return {robot: {} for robot in self.robots}, self._infos()

    def step(self, actions: Mapping[str, int]) -> tuple[Any, ...]:
        """One round of the skill table."""
        subtasks: dict[str, Subtask] = {r: self.vocabulary.subtask(token) for r, token in actions.items()}
        self.world, outcomes = transition(self.scene, self.world, subtasks)
        self.outcomes = {r: {"status": o.status, "reason": o.reason} for r, o in outcomes.items()}
        self.rounds += 1
        infos = self._infos()
        done = all(subtask.skill == "done" for subtask in subtasks.values())
        if self.won or done or self.rounds >= self.max_rounds:
            self.agents = []
        return {robot: {} for robot in self.robots}, {}, {}, {}, infos

    @property
    def won(self) -> bool:
        """Whether the goal holds."""
        return self.goal.holds(self.scene, self.world)

    def _infos(self) -> dict[str, Any]:
        told = {
            "text": "",
            "goal": self.sentence,
            "commands": self.commands,
            "scene": self.scene,
            "verbs": self.verbs,
            "feedback": "status",
            "success": self.won,
            "world": self.world,
            "episode": {"task": self.name, "seed": self.seed, "digest": self.name},
        }
        return {robot: {**told, "outcome": self.outcomes.get(robot)} for robot in self.robots}

    def _object_nouns(self) -> list[Noun]:
        return [
            Noun(name, "object", ("pick up", "place to") if facts.holds else ("pick up",))
            for name, facts in self.objects.items()
        ]


def _fixture_noun(facts: FixtureFacts) -> Noun:
    uses = ["place to"] if facts.slots else []
    uses += ["open door", "close door"] if facts.door else []
    uses += ["turn on", "turn off"] if facts.switches else []
    return Noun(facts.name, "fixture", tuple(uses))


class Spy:
    """A planner that keeps its requests and answers as told."""

    def __init__(self, *replies: Any) -> None:
        self.replies, self.requests = list(replies), []

    def plan(self, request: PlanRequest) -> Any:
        self.requests.append(request)
        return self.replies.pop(0) if self.replies else []
