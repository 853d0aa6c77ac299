"""Busy robots dropped: who learns with RLlib's conventions sees none but those robots that must decide."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pettingzoo.utils import BaseParallelWrapper

from remac_env.envs.event_parallel import KitchenEventEnv
from remac_env.errors import ActionError


class ReadyOnly(BaseParallelWrapper[str, Any, int]):
    """A kitchen under the event clock that answers with ready robots alone, and takes tokens of these alone.

    The reward of a robot is all that it has gained since its last decision. At the end all robots are told. `agents`
    are all that live, ready or not, so that PettingZoo's own test of parallel environments does not hold for it.
    """

    def __init__(self, env: KitchenEventEnv) -> None:
        super().__init__(env)
        self.kitchen = env

    def reset(
        self, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Begin the episode of this seed; see KitchenParallelEnv.reset."""
        seen, self._infos = self.kitchen.reset(seed=seed, options=options)
        return seen, self._infos

    def step(
        self, actions: Mapping[str, int]
    ) -> tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Run until somebody must decide.

        Args:
            actions: a token for every robot that was answered last.

        Raises:
            ActionError: for a robot that was not; nothing has changed then.
        """
        ready = [robot for robot in self.kitchen.agents if self._infos[robot]["ready"]]
        if self.kitchen.agents and set(actions) != set(ready):
            raise ActionError(f"actions for {sorted(actions)}; valid: one for each of {ready}, who are ready")
        tokens = dict(actions)
        while True:
            goes_on = {robot: self._infos[robot]["continue"] for robot in self.kitchen.agents}
            seen, _, terminations, truncations, self._infos = self.kitchen.step(goes_on | tokens)
            told = [robot for robot, info in self._infos.items() if info["ready"] or not self.kitchen.agents]
            if told:
                break
            tokens = {}
        return (
            {robot: seen[robot] for robot in told},
            {robot: self._infos[robot]["return"] for robot in told},
            {robot: terminations[robot] for robot in told},
            {robot: truncations[robot] for robot in told},
            {robot: self._infos[robot] for robot in told},
        )
