"""The same kitchen as one gymnasium.Env: all robots' tokens in one action, all observations in one dict."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from remac_env.actions import check_token
from remac_env.errors import ActionError
from remac_env.options import Options
from remac_env.parallel import KitchenParallelEnv
from remac_env.tasks import get as get_task


class KitchenEnv(gymnasium.Env[dict[str, Any], Any]):
    """A task as a Gymnasium environment.

    Action: Discrete(N) for one robot, MultiDiscrete([N, N]) for two. Observation keys are flat: `robot_0.observation`,
    `robot_0.action_mask` ... `info["robots"][name]` is what the parallel environment tells that robot.
    """

    metadata = {"render_modes": ["rgb_array", "human"], "render_fps": 20}

    def __init__(self, task: str, *, robots: int = 1, **options: Any) -> None:
        self.parallel = KitchenParallelEnv(get_task(task), Options(robots=robots, **options))
        self.render_mode = self.parallel.render_mode
        self.vocabulary = self.parallel.vocabulary
        names, n = self.parallel.possible_agents, len(self.vocabulary)
        self.action_space = spaces.Discrete(n) if len(names) == 1 else spaces.MultiDiscrete([n] * len(names))
        self.observation_space = spaces.Dict(
            {
                f"{name}.{key}": space
                for name in names
                for key, space in self.parallel.observation_spaces[name].spaces.items()
            }
        )
        self._begun = self._running = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin the episode of this seed; see KitchenParallelEnv.reset."""
        observations, infos = self.parallel.reset(seed=seed, options=options)
        super().reset(seed=None if seed is None else int(seed))  # second: the kitchen's own error for a bad seed
        self._begun = self._running = True
        return self._flat(observations), self._info(infos)

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Run one round.

        Raises:
            gymnasium.error.ResetNeeded: before reset or after the end of the episode.
            ActionError: for an action of another shape or type; nothing has changed then.
        """
        if not self._running:
            raise ResetNeeded("step() needs an episode under way: call reset() first")
        outputs = self.parallel.step(self._split(action))
        observations, rewards, terminations, truncations, infos = outputs
        name = self.parallel.possible_agents[-1]  # all robots end together with one reward
        self._running = not (terminations[name] or truncations[name])
        return self._flat(observations), rewards[name], terminations[name], truncations[name], self._info(infos)

    def render(self) -> Any:
        """See KitchenParallelEnv.render."""
        if not self._begun:
            raise ResetNeeded("render() needs an episode under way: call reset() first")
        return self.parallel.render()

    def close(self) -> None:
        """Free the simulator and the renderer. May be called twice."""
        self._running = False
        self.parallel.close()

    def action_masks(self) -> NDArray[np.bool_]:
        """Legal tokens as one flat vector over all robots, bool (robots * N,)."""
        mask = self.vocabulary.mask(self.parallel.start.scene).astype(bool)
        return np.tile(mask, len(self.parallel.possible_agents))

    def _split(self, action: Any) -> dict[str, int]:
        names = self.parallel.possible_agents
        if len(names) == 1:
            return {name: check_token(action, name) for name in names}
        several = isinstance(action, list | tuple) or (isinstance(action, np.ndarray) and action.ndim > 0)
        values = list(action) if several else [action]
        if not several:
            check_token(action, " and ".join(names))
        if len(values) != len(names):
            raise ActionError(f"action {action!r} has {len(values)} tokens for the robots {names}")
        return {name: check_token(value, name) for name, value in zip(names, values, strict=True)}

    @staticmethod
    def _flat(observations: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
        return {f"{name}.{key}": value for name, seen in observations.items() for key, value in seen.items()}

    @staticmethod
    def _info(infos: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
        return {"robots": dict(infos)}
