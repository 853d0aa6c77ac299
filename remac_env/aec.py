"""The AEC version: robots speak one after the other, and the round is run when the last has spoken."""

from __future__ import annotations

from typing import Any

from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from remac_env.actions import check_token
from remac_env.errors import LifecycleError
from remac_env.parallel import KitchenParallelEnv
from remac_env.vocabulary import Vocabulary


class KitchenAECEnv(OrderEnforcingWrapper[str, Any, Any]):
    """PettingZoo's conversion, which refuses a malformed token at once and not when the round is run."""

    def __init__(self, kitchen: KitchenParallelEnv) -> None:
        super().__init__(parallel_to_aec_wrapper(kitchen))
        self.vocabulary: Vocabulary = kitchen.vocabulary

    def step(self, action: Any) -> None:
        """Give the token of the robot whose turn it is (None for one whose episode has ended).

        Raises:
            LifecycleError: before reset.
            ActionError: if it is not a whole number; nothing has changed then.
        """
        if not self._has_reset:
            raise LifecycleError("step() needs an episode under way: call reset() first")
        over = bool(self.agents) and (self.terminations[self.agent_selection] or self.truncations[self.agent_selection])
        if self.agents and not over:
            action = check_token(action, self.agent_selection)
        super().step(action)
