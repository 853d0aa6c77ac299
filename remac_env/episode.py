"""One running episode: its start, what has happened so far, how it stands, and what each robot is told of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

from remac_env.backends.base import Counters, RoundResult
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.options import Options
from remac_env.rules.facts import Rules
from remac_env.rules.knowledge import as_known, in_view
from remac_env.rules.outcomes import Outcome
from remac_env.rules.scene import public_scene
from remac_env.rules.subtasks import Subtask
from remac_env.start import Start
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal, lost, progress
from remac_env.tasks.spec import TaskSpec
from remac_env.text import describe, describe_outcome, describe_states, describe_unseen

End = Literal["success", "lost", "done", "truncated"]


@dataclass(frozen=True)
class Terms:
    """What stays the same during an episode. `commands`: text -> token of every legal subtask."""

    spec: TaskSpec
    options: Options
    start: Start
    goal: Goal
    sentence: str
    commands: Mapping[str, int]
    phases: tuple[tuple[str, Goal], ...] = ()

    @classmethod
    def of(cls, worlds: TaskWorlds, options: Options, start: Start, names: Mapping[str, str]) -> Terms:
        """The terms of a start; `names`: role -> object."""
        spec = worlds.spec
        sentence = spec.sentence(options.wording, worlds.nouns(start, names))
        phases = tuple((name, goal.bind(names)) for name, goal in spec.phases)
        commands = worlds.vocabulary.legal(start.scene)
        return cls(spec, options, start, spec.goal.bind(names), sentence, commands, phases)

    @cached_property
    def scene(self) -> Rules:
        """The facts of this kitchen."""
        return self.start.scene

    @cached_property
    def max_seconds(self) -> float:
        """When the episode is over under the event clock, s."""
        return max_seconds(self.spec, self.options)

    @cached_property
    def label(self) -> dict[str, Any]:
        """The episode's cell, seed and digest, as infos and records carry it.

        How long a known plan is hangs on what is behind doors: it is told to those alone who may know that.
        """
        made = self.spec.generated
        known = {} if not made or self.scene.hides else {"known_rounds": made["upper"]}
        return {
            "task": self.spec.name,
            "style": self.start.style,
            "layout": self.start.layout,
            "starts": self.options.starts,
            "seed": self.start.seed,
            "digest": self.start.digest,
            "robots": len(self.scene.robots),
            "backend": self.options.backend,
            **({} if not made else {"template": made["template"]}),
            **known,
        }

    @property
    def max_rounds(self) -> int:
        """Rounds after which the episode is truncated."""
        return max(self.options.max_rounds, self.spec.rounds or 0)

    @cached_property
    def texts(self) -> dict[str, str]:
        """What each robot is told of itself and of the kitchen."""
        public, notes = public_scene(self.scene), [process.told for process in self.scene.processes]
        kitchen = describe(public, list(self.commands), self.sentence, clock=self.options.clock, notes=notes)
        return {robot: f"You are {robot}.\n{kitchen}" for robot in self.scene.robots}


def max_seconds(spec: TaskSpec, options: Options) -> float:
    """When an episode is over under the event clock: at the task's deadline where it has one, s."""
    return options.max_seconds if spec.deadline is None else min(options.max_seconds, spec.deadline)


@dataclass
class Episode:
    """The changeable side: the world at rest after `rounds` rounds, and how the last one went.

    `seen`: the objects of which the team knows where they are.
    """

    terms: Terms
    world: WorldState
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    counters: Counters = field(default_factory=Counters)
    seconds: float = 0.0
    rounds: int = 0
    done: frozenset[str] = frozenset()
    end: End | None = None
    phases_done: int = 0
    seen: frozenset[str] = frozenset()
    _judged: WorldState | None = field(default=None, init=False, repr=False)
    _fate: End | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        """Look about."""
        self._look_about()

    @property
    def unseen(self) -> frozenset[str]:
        """The objects that nobody on the team has seen; none with knowledge="full"."""
        return frozenset(self.world.objects) - self.seen if self.terms.scene.hides else frozenset()

    @property
    def known(self) -> WorldState:
        """The world without them."""
        return as_known(self.world, self.seen)

    def _look_about(self) -> None:
        if self.terms.scene.hides:
            self.seen |= in_view(self.terms.scene, self.world)
        elif not self.seen:
            self.seen = frozenset(self.world.objects)

    def advance(self, subtasks: Mapping[str, Subtask], invalid: Mapping[str, Outcome], result: RoundResult) -> None:
        """Take over a round's result and judge it."""
        self.world = result.world
        self.outcomes = {**result.outcomes, **{name: _at(invalid[name], result.outcomes[name]) for name in invalid}}
        self.counters = self.counters + result.counters
        self.seconds += result.seconds
        before = self.done
        self.done = frozenset(
            [n for n, s in subtasks.items() if s.skill == "done" or (s.skill == "wait" and n in before)]
        )
        self.look()

    def look(self) -> None:
        """Judge the world as it is after one more round."""
        self._look_about()
        self.rounds += 1
        if self.world is not self._judged:
            # A refused command leaves the very same world, and how that stands is known.
            self._judged, self._fate = self.world, self._look_at_goals()
        self.end = self._judge()

    def _look_at_goals(self) -> End | None:
        """How the world decides the episode; phases that have been reached stay so."""
        scene, world, goal = self.terms.scene, self.world, self.terms.goal
        for _, phase in self.terms.phases[self.phases_done :]:
            if not phase.holds(scene, world):
                break
            self.phases_done += 1
        if goal.holds(scene, world):
            return "success"
        return "lost" if lost(goal, scene, world) else None

    @property
    def progress(self) -> float:
        """The fraction of the goal's parts that hold, 0..1."""
        return progress(self.terms.goal, self.terms.scene, self.world)

    def infos(self, robots: Iterable[str]) -> dict[str, dict[str, Any]]:
        """What infos hold of each of these robots: each key always of one type, as vector environments need it."""
        alike = self._alike()
        return {robot: {**alike, **self._own(robot)} for robot in robots}

    def _alike(self) -> dict[str, Any]:
        """What all robots are told alike, and in which order: that each is told of its own stands in it as None."""
        terms = self.terms
        return {
            "outcome": None,
            "text": None,
            "goal": terms.sentence,
            "episode": None,
            "success": self.end == "success",
            "end": self.end or "",
            "world": self.world,
            "scene": terms.scene,
            "commands": None,
            "goal_test": terms.goal,
            "verbs": None,
            "unseen": None,
            "feedback": terms.options.feedback,
            "phases": None,
            "round": self.rounds,
            "seconds": float(self.seconds),
            "robot_contacts": int(self.counters.robot_contacts),
            "near_misses": int(self.counters.near_misses),
            "physics_steps": int(self.counters.physics_steps),
        }

    def _own(self, robot: str) -> dict[str, Any]:
        """What a robot is told of itself, and copies of its own of what can be changed."""
        terms, done = self.terms, self.phases_done
        return {
            "outcome": self._outcome(robot),
            "text": self._text(robot),
            "episode": dict(terms.label),
            "commands": dict(terms.commands),
            "verbs": dict(terms.spec.verbs),
            "unseen": sorted(self.unseen),
            "phases": {name: index < done for index, (name, _) in enumerate(terms.phases)},
        }

    def _judge(self) -> End | None:
        if self._fate is not None:
            return self._fate
        if len(self.done) == len(self.terms.scene.robots):
            return "done"
        return "truncated" if self.out_of_time else None

    @property
    def out_of_time(self) -> bool:
        """Whether the episode is as long as it may be."""
        return self.rounds >= self.terms.max_rounds

    def _outcome(self, robot: str) -> dict[str, Any]:
        """How the robot's last subtask ended; empty before the first."""
        outcome = self.outcomes.get(robot)
        if outcome is None:
            return {}
        return {
            "status": outcome.status,
            "reason": outcome.reason or "",
            "detail": outcome.detail,
            "seconds": float(outcome.seconds),
            "began": float(outcome.began),
            "ended": float(outcome.ended),
        }

    def _text(self, robot: str) -> str:
        options, text = self.terms.options, self.terms.texts[robot]
        if options.text == "states":
            text += "\n" + describe_states(self.terms.scene, self.known)
        if self.unseen:
            text += "\n" + describe_unseen(self.unseen)
        last = describe_outcome(self.outcomes.get(robot), feedback=options.feedback)
        return f"{text}\n{last}" if last else text


def _at(invalid: Outcome, waited: Outcome) -> Outcome:
    """The outcome of a command that means nothing, at the time at which its robot waited instead."""
    return replace(invalid, began=waited.began, ended=waited.ended)
