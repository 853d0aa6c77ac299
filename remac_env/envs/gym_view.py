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
from remac_env.envs.making import make_kitchen
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import ActionError
from remac_env.options import Options
from remac_env.quoting import quoted
from remac_env.tasks import get as get_task
from remac_env.values import python_value


class KitchenEnv(gymnasium.Env[Any, Any]):
    """A task as a Gymnasium environment.

    Action: Discrete(N) for one robot, MultiDiscrete([N, N, ...]) for several. Observation: a dict without levels, with
    the keys `robot_0_observation`, `robot_0_action_mask` ... (names that PyTorch's modules may have); with
    obs_format="flat" one vector, the robots' one after the other. `info["robots"][name]` is what the parallel
    environment tells that robot.

    Attributes:
        parallel: that environment.
        vocabulary: what tokens say.
        action_space, observation_space, metadata, render_mode: as Gymnasium has them.
    """

    metadata = {"render_modes": ["rgb_array", "work", "human"], "render_fps": 1}

    def __init__(self, task: str, *, robots: int = 1, **options: Any) -> None:
        self.parallel: KitchenParallelEnv = make_kitchen(get_task(task), Options(robots=robots, **options))
        self.render_mode = self.parallel.render_mode
        self.vocabulary = self.parallel.vocabulary
        names, n = self.parallel.possible_agents, len(self.vocabulary)
        self.action_space = spaces.Discrete(n) if len(names) == 1 else spaces.MultiDiscrete([n] * len(names))
        self.observation_space = self._joint_space()
        self._begun = self._running = False

    def __str__(self) -> str:
        """As the parallel environment says it."""
        return repr(self.parallel)

    __repr__ = __str__

    def _repr_png_(self) -> bytes | None:
        """The kitchen now, for notebooks."""
        return self.parallel._repr_png_()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin the episode of this seed; see KitchenParallelEnv.reset."""
        observations, infos = self.parallel.reset(seed=seed, options=options)
        super().reset(seed=python_value(seed))  # second: the kitchen's own error for a bad seed
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
        name = self.parallel.possible_agents[-1]  # all robots end together with one reward
        outputs = self.parallel.step(self._split(action))
        observations, rewards, terminations, truncations, infos = outputs
        self._running = not (terminations[name] or truncations[name])
        return self._flat(observations), rewards[name], terminations[name], truncations[name], self._info(infos)

    def render(self) -> Any:
        """See KitchenParallelEnv.render; ResetNeeded before the first reset."""
        if not self._begun:
            raise ResetNeeded("render() needs an episode under way: call reset() first")
        return self.parallel.render()

    def close(self) -> None:
        """Free the simulator and the renderer. May be called twice."""
        self._running = False
        self.parallel.close()

    def action_masks(self) -> NDArray[np.bool_]:
        """The tokens that may be chosen, as the option `masks` says: one vector over all robots, bool (robots * N,)."""
        return np.concatenate([self.parallel.action_mask(name) for name in self.parallel.possible_agents]).astype(bool)

    def _split(self, action: Any) -> dict[str, int]:
        names = self.parallel.possible_agents
        if len(names) == 1:
            return {name: check_token(action, name) for name in names}
        several = isinstance(action, list | tuple) or (isinstance(action, np.ndarray) and action.ndim > 0)
        values = list(action) if several else [action]
        if not several:
            check_token(action, " and ".join(names))
        if len(values) != len(names):
            raise ActionError(f"action {quoted(action)} has {len(values)} tokens; valid: {len(names)}, of {names}")
        return {name: check_token(value, name) for name, value in zip(names, values, strict=True)}

    def _joint_space(self) -> spaces.Space[Any]:
        parts = self.parallel.observation_spaces
        dicts = {name: part.spaces for name, part in parts.items() if isinstance(part, spaces.Dict)}
        if dicts:
            return spaces.Dict({f"{name}_{key}": part for name, keys in dicts.items() for key, part in keys.items()})
        size = sum(int(np.prod(part.shape or ())) for part in parts.values())
        return spaces.Box(0.0, 1.0, (size,), np.float32)

    def _flat(self, observations: Mapping[str, Any]) -> Any:
        if not isinstance(self.observation_space, spaces.Dict):
            return np.concatenate(list(observations.values()))
        return {f"{name}_{key}": value for name, seen in observations.items() for key, value in seen.items()}

    @staticmethod
    def _info(infos: Mapping[str, dict[str, Any]]) -> dict[str, Any]:
        return {"robots": dict(infos)}
