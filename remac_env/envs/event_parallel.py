"""The kitchen under the event clock as a PettingZoo ParallelEnv: a step runs to the next decision point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_env.actions import check_actions, check_robot, decode
from remac_env.backends.base import Backend
from remac_env.envs.parallel import KitchenParallelEnv, Seen, Told
from remac_env.episode import Episode, Terms, max_seconds
from remac_env.errors import LifecycleError, OptionError, UnknownNameError
from remac_env.event_episode import EventEpisode
from remac_env.events.clock import EventClock, Order, Span
from remac_env.events.observation import TimeFacts
from remac_env.pictures import Moment
from remac_env.quoting import quoted
from remac_env.rules.knowledge import held_back
from remac_env.rules.subtasks import Subtask
from remac_env.thinking import NO_THOUGHT, Thought, thinking_seconds
from remac_env.vocabulary import Vocabulary

CONTINUE, STOP = "continue", "stop"
"""What a busy robot is told: to go on with what it is at; or, where that may be, to stop."""


class KitchenEventEnv(KitchenParallelEnv):
    """A task whose robots do not wait for each other. Every step runs to the next decision point.

    The last token of the vocabulary is `continue`: a busy robot's mask holds it and nothing else, and whatever else it
    is told changes nothing. With `interrupts=True` there is `stop` behind it, which a busy robot's mask holds too: its
    controller then ends at its next safe pose, see `Backend.stop`, and a thought in a second.

    A robot's mask is that of the rounds whenever it is ready. `infos` say beside the rest: `ready`; `running`, the
    command that is under way, or "thinking" ("": none); `elapsed`, for how many seconds; `seconds`, the clock; `tau`
    and `return`, seconds and rewards since the robot's last decision; `decision`, how many it has made; `continue`, the
    token; `max_seconds`. `outcome` is {} unless the robot's subtask ended just now.
    Observations end in figures about time: `remac_env.events.observation`.
    """

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Seen, Told]:
        """Begin the episode of this seed; see KitchenParallelEnv.reset."""
        self._thoughts: dict[str, Thought] = {}
        return super().reset(seed=seed, options=options)

    def step(
        self, actions: Mapping[str, int]
    ) -> tuple[Seen, dict[str, float], dict[str, bool], dict[str, bool], Told]:
        """Run to the next decision point: a subtask ended, an event became visible, a thought arrived, or time is up.

        Args:
            actions: a token for every robot in `agents`. For a ready robot a masked or unknown token is a second lost,
                outcome `invalid`.

        Raises:
            LifecycleError: before reset, after the end of the episode, or after close.
            ActionError: for missing or unknown robots, or values that are not whole numbers; nothing has changed then.
        """
        backend, episode = self._playing(), self._timed()
        tokens = check_actions(actions, self.agents)
        subtasks, refused = decode({robot: tokens[robot] for robot in episode.clock.ready}, self._legal)
        if episode.terms.scene.hides:
            subtasks, refused = held_back(subtasks, episode.unseen, refused)
        thoughts, self._thoughts = self._thoughts, {}
        orders = {
            robot: Order(subtask, self._cost(subtask, thoughts.get(robot)), refused.get(robot))
            for robot, subtask in subtasks.items()
        }
        episode.decided(orders)
        outcomes = episode.clock.run(orders, self._stopped(tokens, orders), episode.unseen)
        episode.arrive(backend.world, outcomes, backend.counters)
        return self._answer(episode)

    @property
    def max_seconds(self) -> float:
        """When an episode is over at the latest, s on its clock."""
        return max_seconds(self.worlds.spec, self.options)

    @property
    def timeline(self) -> tuple[Span, ...]:
        """What lasted how long in the episode by now: subtasks, waits, thoughts."""
        return self._timed().clock.timeline

    def note_thought(self, robot: str, thought: Thought) -> None:
        """Say what went into the token that a robot is given in the next step; `think` says what that costs.

        Raises:
            LifecycleError: where no episode is under way.
            UnknownNameError: for a robot that must not decide now.
        """
        self._playing()
        ready = self._timed().clock.ready
        if not isinstance(robot, str) or robot not in ready:
            raise UnknownNameError(f"{quoted(robot)} is not asked now; valid: {', '.join(ready) or 'none'}")
        if not isinstance(thought, Thought):
            raise OptionError(f"thought {quoted(thought)} is not valid; valid: a remac_env.thinking.Thought")
        self._thoughts[robot] = thought

    def action_mask(self, agent: str) -> NDArray[np.int8]:
        """The tokens that this robot may choose now; 1 or 0, shape (N,). Never without a 1."""
        check_robot(agent, self.possible_agents)
        return super().action_mask(agent) if self._timed().clock.doing(agent) is None else self._busy.copy()

    def _stopped(self, tokens: Mapping[str, int], orders: Mapping[str, Order]) -> list[str]:
        """The robots that are busy and told to stop."""
        if self._stop is None:
            return []
        return [robot for robot in self.agents if robot not in orders and tokens[robot] == self._stop]

    def _cost(self, subtask: Subtask, thought: Thought | None) -> float:
        """What a command costs, s; to go on waiting without a thought costs nothing."""
        if self.options.think == "off" or subtask.row.still and (thought is None or thought == NO_THOUGHT):
            return 0.0
        return thinking_seconds(self.options.think, thought or NO_THOUGHT)

    def _words(self) -> Vocabulary:
        return self.worlds.vocabulary.with_words((CONTINUE, *((STOP,) if self.options.interrupts else ())))

    @cached_property
    def _continue(self) -> int:
        return self.vocabulary.encode(CONTINUE)

    @cached_property
    def _stop(self) -> int | None:
        return self.vocabulary.encode(STOP) if self.options.interrupts else None

    @cached_property
    def _busy(self) -> NDArray[np.int8]:
        """The mask of a busy robot."""
        mask = np.zeros(len(self.vocabulary), np.int8)
        mask[[token for token in (self._continue, self._stop) if token is not None]] = 1
        return mask

    def _begin(self, terms: Terms, backend: Backend) -> Episode:
        world = backend.reset(terms.start)
        clock = EventClock(backend, terms.scene, deadline=terms.max_seconds)
        return EventEpisode(terms, world, clock=clock, continues=self._continue, stops=self._stop)

    def _moment(self) -> Moment:
        return replace(super()._moment(), slow=self._timed().shares)

    def _timed(self) -> EventEpisode:
        episode = self._running()
        if not isinstance(episode, EventEpisode):
            raise LifecycleError("this episode has no clock: call reset() first")
        return episode

    def _pay(self, episode: Episode) -> float:
        reward = super()._pay(episode)
        self._timed().gain(reward)
        return reward

    @property
    def _room(self) -> int:
        return self._time.size

    def _vectors(self) -> dict[str, NDArray[np.float32]]:
        seen, episode = super()._vectors(), self._timed()
        self._time.write(seen, episode.clock, episode.world, episode.unseen)
        return seen

    @cached_property
    def _time(self) -> TimeFacts:
        nouns = (noun.name for noun in self.vocabulary.nouns)
        slow = [name for name, _ in self.worlds.spec.processes]
        return TimeFacts(self.possible_agents, slow, nouns, deadline=self.max_seconds)
