"""The event clock as an AEC environment: robots that must decide are asked, and the world runs when none is left."""

from __future__ import annotations

from typing import Any

from gymnasium import spaces
from numpy.typing import NDArray
from pettingzoo import AECEnv
from pettingzoo.utils.agent_selector import AgentSelector

from remac_env.actions import check_robot, check_token
from remac_env.envs.event_parallel import STOP, KitchenEventEnv
from remac_env.errors import ActionError, LifecycleError, UnknownNameError
from remac_env.quoting import quoted
from remac_env.thinking import Thought
from remac_env.vocabulary import Vocabulary


class KitchenEventAEC(AECEnv[str, Any, Any]):
    """A native AEC environment: `agent_iter` yields none but robots that are ready.

    What a robot gains from its decision to its next one is its reward when it is asked again: the return of what it
    did. After the end every robot is asked once more, for None.
    """

    agent_selection: str  # of the base, which says no type

    def __init__(self, kitchen: KitchenEventEnv) -> None:
        super().__init__()
        self.kitchen = kitchen
        self.vocabulary: Vocabulary = kitchen.vocabulary
        self.metadata = {**kitchen.metadata, "is_parallelizable": False}
        self.render_mode = kitchen.render_mode
        self.possible_agents = list(kitchen.possible_agents)
        self.observation_spaces = dict(kitchen.observation_spaces)
        self.action_spaces = dict(kitchen.action_spaces)
        self.agents: list[str] = []
        self._begun = False

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """The space of this robot's observations; always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """The space of this robot's tokens; always the same object."""
        return self.action_spaces[agent]

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        """Begin the episode of this seed; see KitchenParallelEnv.reset. A refused reset begins nothing."""
        self._seen, self.infos = self.kitchen.reset(seed=seed, options=options)
        self.agents = list(self.possible_agents)
        self.rewards = dict.fromkeys(self.agents, 0.0)
        self._cumulative_rewards = dict.fromkeys(self.agents, 0.0)
        self.terminations = dict.fromkeys(self.agents, False)
        self.truncations = dict.fromkeys(self.agents, False)
        self._tokens: dict[str, int] = {}
        self._begun = True
        self._ask(self._ready())

    def observe(self, agent: str) -> Any:
        """What a robot saw at the last decision point."""
        if not self._begun:
            raise LifecycleError("observe() needs an episode under way: call reset() first")
        check_robot(agent, self.possible_agents)
        return self._seen[agent]

    def last(self, observe: bool = True) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """What the robot that is asked has seen and gained; LifecycleError when nobody is left to be asked."""
        if not self.agents:
            raise LifecycleError("last() needs an episode under way: call reset() first")
        return super().last(observe)

    def step(self, action: Any) -> None:
        """Give the token of the robot that is asked (None for one whose episode has ended).

        Raises:
            LifecycleError: before reset, and after the end.
            ActionError: if it is not a whole number, or not None where it must be; nothing has changed then.
        """
        if not self.agents:
            raise LifecycleError("step() needs an episode under way: call reset() first")
        robot = self.agent_selection
        if self.terminations[robot] or self.truncations[robot]:
            if action is not None:
                raise ActionError(f"action of {robot} is {quoted(action)}; valid: None, as its episode has ended")
            self._was_dead_step(action)
            return
        self._tokens[robot] = check_token(action, robot)
        self._cumulative_rewards[robot] = 0.0
        self.rewards = dict.fromkeys(self.agents, 0.0)
        if self._asked.is_last():
            self._run()
        else:
            self.agent_selection = self._asked.next()

    def stop(self, robot: str) -> None:
        """Tell a busy robot to stop when the world runs next; it is not asked until it has. Needs `interrupts=True`.

        Raises:
            LifecycleError: before reset, after the end, or where robots may not be told to.
            UnknownNameError: for a robot that is not busy.
        """
        if not self.agents or not any("stop" in info for info in self.infos.values()):
            raise LifecycleError("stop() needs an episode under way with interrupts=True")
        busy = [name for name in self.kitchen.agents if not self.infos[name]["ready"]]
        if robot not in busy:
            raise UnknownNameError(f"{quoted(robot)} is not busy; valid: {', '.join(busy) or 'none'}")
        self._tokens[robot] = self.vocabulary.encode(STOP)

    def note_thought(self, robot: str, thought: Thought) -> None:
        """See KitchenEventEnv.note_thought."""
        self.kitchen.note_thought(robot, thought)

    def action_mask(self, agent: str) -> NDArray[Any]:
        """See KitchenEventEnv.action_mask."""
        return self.kitchen.action_mask(agent)

    def render(self) -> Any:
        """See KitchenParallelEnv.render."""
        return self.kitchen.render()

    def state(self) -> NDArray[Any]:
        """See KitchenParallelEnv.state."""
        return self.kitchen.state()

    def close(self) -> None:
        """Free the simulator and the renderer. May be called twice."""
        self.kitchen.close()

    def _run(self) -> None:
        """Let the world run until somebody must decide, or the episode is over."""
        goes_on = self.vocabulary.encode("continue")
        ended = False
        while not ended:
            tokens = {robot: self._tokens.get(robot, goes_on) for robot in self.kitchen.agents}
            self._tokens = {}
            self._seen, gained, self.terminations, self.truncations, self.infos = self.kitchen.step(tokens)
            for robot, reward in gained.items():
                self.rewards[robot] += reward
            ended = any((*self.terminations.values(), *self.truncations.values())) or bool(self._ready())
        self._accumulate_rewards()
        self._ask(self._ready() if self.kitchen.agents else self.agents)

    def _ready(self) -> list[str]:
        return [robot for robot in self.kitchen.agents if self.infos[robot]["ready"]]

    def _ask(self, robots: list[str]) -> None:
        self._asked = AgentSelector(robots)
        self.agent_selection = self._asked.reset()
