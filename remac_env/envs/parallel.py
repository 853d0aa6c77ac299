"""The kitchen as a PettingZoo ParallelEnv. Orchestration only: starts, rounds and what comes back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from remac_env.actions import check_actions, check_robot, decode
from remac_env.backends import make_backend, told_cases, told_skills
from remac_env.backends.base import Backend
from remac_env.envs.openings import observation_space, reset_options
from remac_env.envs.recordings import Recordings
from remac_env.episode import Episode, Terms
from remac_env.errors import LifecycleError
from remac_env.generator.worlds import worlds_for
from remac_env.observation import Facts
from remac_env.options import USUAL_CAMERAS, Options
from remac_env.pictures import Moment, Pictures
from remac_env.rewards import make_reward
from remac_env.rules.claims import feasible
from remac_env.rules.knowledge import held_back
from remac_env.seeding import KEPT_SEEDS, generator
from remac_env.start import Start
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal
from remac_env.tasks.spec import TaskSpec
from remac_env.values import python_value
from remac_env.vocabulary import Vocabulary

Seen = dict[str, Any]
"""Robot -> its observation."""

Told = dict[str, dict[str, Any]]
"""Robot -> its info."""


class KitchenParallelEnv(Recordings, ParallelEnv[str, Any, int]):
    """A task with one to four robots; every step is a round in which each robot runs one subtask.

    Made by `remac_env.parallel_env`, which documents the options. Actions are tokens of `vocabulary`; observations are
    `{"observation": float32 (n,) in 0..1, "action_mask": int8 (N,)}` and, with obs="state+images", the pictures of
    `cameras`: uint8 (size, size, 3). With obs_format="flat" they are the vector alone, and infos have `action_mask`.

    Attributes:
        vocabulary: what tokens say. options, metadata, render_mode: as it was made.
        possible_agents, agents: all robots, and those that play on. observation_spaces, action_spaces: theirs, by name.
        skills: skill -> who moves robots in it; skill_cases: skill -> the cases in which its weights do.
    """

    def __init__(self, spec: TaskSpec, options: Options) -> None:
        self.worlds, self.options = worlds_for(spec, options), options
        self.vocabulary = self._words()
        self.metadata = {
            "name": f"RemacKitchen-{spec.name}-v0",
            "render_modes": ["rgb_array", "work", "human"], "is_parallelizable": True, "render_fps": 1,
        }
        self.render_mode, self.skills, self.skill_cases = options.render_mode, told_skills(options), told_cases(options)
        self.possible_agents = list(options.robot_names)
        self.agents: list[str] = []
        self._facts = Facts(self.vocabulary, options.robots, self.worlds.marks, room=self._room)
        self._reward = make_reward(options.reward)
        self.action_spaces = {name: spaces.Discrete(len(self.vocabulary)) for name in self.possible_agents}
        sizes = {"facts": self._facts.size + self._room, "tokens": len(self.vocabulary)}
        self.observation_spaces = {name: observation_space(options, **sizes) for name in self.possible_agents}
        self._backend: Backend | None = None
        self._episode: Episode | None = None
        self._pictures = Pictures(self.worlds)
        self._closed = False
        self._seeds = np.random.default_rng()

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        """A copy: the same episode and generators, with renderers of its own that are made when they are needed."""
        self.__dict__.update(state)
        if self._backend is not None:
            self._backend.watch, self._backend.pictures = self._film, self._look

    def __repr__(self) -> str:
        """The task, the options that are not the default ones, and how far the episode is."""
        state = "closed" if self._closed else "not reset" if self._episode is None else f"round {self._episode.rounds}"
        return f"<{' '.join([self.worlds.spec.name, *self.options.chosen])}, {state}>"

    def _repr_png_(self) -> bytes | None:
        """The kitchen now, for notebooks; None where no episode has begun, or it cannot be drawn."""
        return None if self._closed or self._episode is None else self._pictures.png(self._moment())

    # -- the PettingZoo interface ------------------------------------------------------------------------------------

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Seen, Told]:
        """Begin the episode of this seed.

        Args:
            seed: whole number from 0; the same seed is the same episode. None draws one.
            options: may hold "style" and "layout" for this episode; other keys are ignored, as PettingZoo's tests ask.

        Raises:
            LifecycleError: after close.
            UnknownNameError: for a style or layout that does not exist.
            OptionError: for a seed that is not a whole number from 0.
        """
        self._check_open()
        seed = python_value(seed)
        if seed is None:
            seed = int(self._seeds.integers(KEPT_SEEDS))
        else:
            self._seeds = generator(seed, "seeds of further resets")
        wanted = reset_options(options)
        worlds = self.worlds.of(seed)
        start, names = worlds.start(
            seed, style=wanted.get("style", self.options.style), layout=wanted.get("layout", self.options.layout),
            starts=self.options.starts, robots=self.options.robot_names, body=self.options.body,
            naming=self.options.naming, knowledge=self.options.knowledge,
            perception_noise=self.options.perception_noise,
        )
        if self._backend is None:
            self._backend = make_backend(self.options, self.worlds)
            self._backend.watch, self._backend.pictures = self._film, self._look
        self._pictures.rewind()
        self._episode = self._begin(Terms.of(worlds, self.options, start, names), self._backend)
        self._film()
        self._mask = self.vocabulary.mask(start.scene)
        self._legal = {token: self.vocabulary.subtask(token) for token in self._episode.terms.commands.values()}
        self.agents = list(self.possible_agents)
        self._reward.begin(start.scene, self.goal, self.world)
        return self._observations(), self._infos()

    def step(self, actions: Mapping[str, int]) -> tuple[Seen, dict[str, float], dict[str, bool], dict[str, bool], Told]:
        """Run one round.

        Args:
            actions: a token for every robot in `agents`. A masked or unknown token is a round lost, outcome `invalid`.

        Raises:
            LifecycleError: before reset, after the end of the episode, or after close.
            ActionError: for missing or unknown robots, or values that are not whole numbers; nothing has changed then.
        """
        backend, episode = self._playing(), self._running()
        subtasks, invalid = decode(check_actions(actions, self.agents), self._legal)
        if self.start.scene.hides:
            subtasks, invalid = held_back(subtasks, episode.unseen, invalid)
        episode.advance(subtasks, invalid, backend.run_round(subtasks))
        return self._answer(episode)

    def _answer(self, episode: Episode) -> tuple[Seen, dict[str, float], dict[str, bool], dict[str, bool], Told]:
        """What `step` returns of an episode that has been judged."""
        self._film()
        reward = self._pay(episode)
        truncated = episode.end == "truncated"
        terminated = episode.end is not None and not truncated
        outputs = (
            self._observations(),
            dict.fromkeys(self.agents, reward), dict.fromkeys(self.agents, terminated),
            dict.fromkeys(self.agents, truncated), self._infos(),
        )
        if episode.end is not None:
            self.agents = []
        return outputs

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """The space of this robot's observations; always the same object."""
        return self.observation_spaces[check_robot(agent, self.possible_agents)]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """The space of this robot's tokens; always the same object."""
        return self.action_spaces[check_robot(agent, self.possible_agents)]

    def render(self) -> NDArray[np.uint8] | None:
        """The kitchen now, uint8 (432, 768, 3), or as `render_work` with render_mode="work"; None without a mode.

        Raises:
            LifecycleError: before reset or after close.
            RenderingError: if no picture can be made with the settings at hand.
        """
        self._check_open()
        self._running()
        if self.render_mode is None:
            return None
        return self._pictures.render(self._moment(), self.render_mode)

    def state(self) -> NDArray[np.float32]:
        """The facts as each robot sees them, one after the other; shape (robots * n,)."""
        episode, facts = self._running(), self._facts
        seen = facts.vectors(episode.terms.scene, episode.known, episode.terms.scene.robots)
        return np.concatenate([values[: facts.size] for values in seen.values()])

    def close(self) -> None:
        """Free the simulator and the renderer. May be called twice."""
        if self._backend is not None:
            self._backend.close()
        self._pictures.close()
        self._backend, self._closed, self.agents = None, True, []

    def action_mask(self, agent: str) -> NDArray[np.int8]:
        """The tokens that this robot may choose now, as the option `masks` says; 1 or 0, shape (N,).

        Raises:
            LifecycleError: before reset or after close.
        """
        episode = self._running()
        check_robot(agent, self.possible_agents)
        mask, scene = self._mask.copy(), episode.terms.scene
        for token, subtask in self._legal.items() if self.options.masks == "feasible" else ():
            known = feasible(scene, episode.world, agent, subtask)
            mask[token] = known and subtask.target not in episode.unseen
        return mask

    # -- what the episode is ----------------------------------------------------------------------------------------

    @property
    def world(self) -> WorldState:
        """The truth about the kitchen at rest."""
        return self._running().world

    @property
    def start(self) -> Start:
        """The exact start of the episode."""
        return self._running().terms.start

    @property
    def goal(self) -> Goal:
        """The terminal goal of the episode."""
        return self._running().terms.goal

    @property
    def progress(self) -> float:
        """The fraction of the goal's parts that hold, 0..1."""
        return self._running().progress

    def _running(self) -> Episode:
        self._check_open()
        if self._episode is None:
            raise LifecycleError("no episode has begun: call reset() first")
        return self._episode

    def _playing(self) -> Backend:
        self._check_open()
        if not self.agents or self._backend is None:
            raise LifecycleError("step() needs an episode under way: call reset() first")
        return self._backend

    def _check_open(self) -> None:
        if self._closed:
            raise LifecycleError("this environment is closed: make a new one")

    def _moment(self) -> Moment:
        positions, episode = None if self._backend is None else self._backend.positions(), self._running()
        return Moment(self.start, self.world, positions, episode.rounds, unseen=episode.unseen)

    def _look(self, robot: str, cameras: Sequence[str] = USUAL_CAMERAS) -> dict[str, NDArray[np.uint8]]:
        """What these cameras of a robot show now."""
        return self._pictures.observe(self._moment(), robot, size=self.options.image_size, cameras=cameras)

    def _film(self) -> None:
        """Called by the backend once a control period, and after each round: the symbolic one has no periods.

        A video is for those who look at an episode that is over: it shows what stands where.
        """
        self._pictures.film(lambda: replace(self._moment(), unseen=frozenset()))

    # -- what a kitchen with another clock has otherwise --------------------------------------------------------------

    def _words(self) -> Vocabulary:
        return self.worlds.vocabulary

    def _begin(self, terms: Terms, backend: Backend) -> Episode:
        return Episode(terms, backend.reset(terms.start))

    def _pay(self, episode: Episode) -> float:
        return self._reward.pay(episode.world, success=episode.end == "success")

    @property
    def _room(self) -> int:
        """Figures that follow the facts in an observation."""
        return 0

    def _vectors(self) -> dict[str, NDArray[np.float32]]:
        episode = self._running()
        return self._facts.vectors(episode.terms.scene, episode.known, self.agents)

    def _observations(self) -> Seen:
        facts = self._vectors()
        if self.options.obs_format == "flat":
            return dict(facts)
        seen: Told = {n: {"observation": facts[n], "action_mask": self.action_mask(n)} for n in self.agents}
        for name in self.agents if self.options.pictures else ():
            seen[name] |= self._look(name, self.options.pictures)
        return seen

    def _infos(self) -> Told:
        told = self._running().infos(self.agents)
        if self.options.obs_format == "flat":
            for name, info in told.items():
                info["action_mask"] = self.action_mask(name)
        return told
