"""The AEC version: robots speak one after the other, and the round is run when the last has spoken."""

from __future__ import annotations

from typing import Any

from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from remac_env.actions import check_robot, check_token
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import ActionError, LifecycleError, RemacError
from remac_env.quoting import quoted
from remac_env.vocabulary import Vocabulary


class KitchenAECEnv(OrderEnforcingWrapper[str, Any, Any]):
    """PettingZoo's conversion, which refuses a malformed token at once and not when the round is run.

    `vocabulary` says what tokens say; all else is PettingZoo's.
    """

    _has_reset: bool  # of the wrapper, which says no type

    def __init__(self, kitchen: KitchenParallelEnv) -> None:
        super().__init__(parallel_to_aec_wrapper(kitchen))
        self.vocabulary: Vocabulary = kitchen.vocabulary

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> None:
        """Begin the episode of this seed; see KitchenParallelEnv.reset. A refused reset begins nothing."""
        begun = self._has_reset
        try:
            super().reset(seed=seed, options=options)
        except RemacError:
            self._has_reset = begun
            raise

    def last(self, observe: bool = True) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """What the robot whose turn it is has seen and gained; LifecycleError when nobody is left to be asked."""
        if self._has_reset and not self.agents:
            raise LifecycleError("last() needs an episode under way: call reset() first")
        return super().last(observe)

    def observe(self, agent: str) -> Any:
        """What a robot saw last; UnknownNameError for no robot."""
        check_robot(agent, self.possible_agents)
        return super().observe(agent)

    def step(self, action: Any) -> None:
        """Give the token of the robot whose turn it is (None for one whose episode has ended).

        Raises:
            LifecycleError: before reset.
            ActionError: if it is not a whole number, or not None where it must be; nothing has changed then.
        """
        if not self._has_reset:
            raise LifecycleError("step() needs an episode under way: call reset() first")
        over = bool(self.agents) and (self.terminations[self.agent_selection] or self.truncations[self.agent_selection])
        if over and action is not None:
            given = f"action of {self.agent_selection} is {quoted(action)}"
            raise ActionError(f"{given}; valid: None, as its episode has ended")
        if self.agents and not over:
            action = check_token(action, self.agent_selection)
        super().step(action)
