"""Robots as the copies of an environment that Stable-Baselines3 and sb3-contrib learn from: one policy for the team.

    from sb3_contrib import MaskablePPO
    from remac_env.integrations.sb3 import vec_env

    MaskablePPO("MlpPolicy", vec_env("OpenCabinetPnP", robots=2, backend="symbolic")).learn(20_000)

One robot alone needs none of this: `gymnasium.make` is enough. Importing this imports Stable-Baselines3 and torch.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv, VecMonitor

from remac_env.envs.making import make_kitchen
from remac_env.envs.parallel import KitchenParallelEnv
from remac_env.errors import OptionError, whole_number
from remac_env.options import Options
from remac_env.tasks import get

START = "start"
"""What `infos["episode"]` of the PettingZoo environment is called here: "episode" is Stable-Baselines3's own key."""

FACTS = "observation"
"""The key of the facts, with `obs_format="dict"`."""


def vec_env(
    task: str, *, robots: int = 2, copies: int = 1, seed: int | None = None, sign: int = 0, **options: Any
) -> VecMonitor:
    """`copies` kitchens whose robots are `robots * copies` environments, with the monitor around them.

    Every one sees and is told what its robot is: observations, action and reward as of `remac_env.parallel_env`. They
    end and begin again together, as a team does. `env_method("action_masks")` is what MaskablePPO asks for. In infos
    `terminal_observation`, `TimeLimit.truncated` and `is_success` are Stable-Baselines3's, `episode` its monitor's, and
    what else there is the kitchen's; its description of the start, elsewhere under "episode", is under "start".

    Args:
        task: one of `remac_env.tasks()`.
        robots: robots in a kitchen.
        copies: kitchens.
        seed: of the first episodes, as `reset` takes it, one more for each kitchen; later ones follow from it. None
            draws them. `env.seed(...)` does the same before the next reset.
        sign: how often it stands behind the facts which robot it is, as ones among zeros: `sign * robots` numbers
            more. With 0, the default, robots that see the same choose the same where each takes its best token, and
            stand in each other's way; 64 was enough to learn from (docs/learning.md).
        options: as for `parallel_env`. "flat" observations, for "MlpPolicy", unless `obs_format="dict"` is chosen.

    Raises:
        UnknownNameError, OptionError: as `parallel_env`; for `copies` below 1, or `sign` outside 0..10,000.
    """
    copies, sign = whole_number("copies", copies, 1, None), whole_number("sign", sign, 0, 10_000)
    chosen = Options(robots=robots, **{"obs_format": "flat", **options})
    if chosen.clock != "rounds":
        raise OptionError(f"clock {chosen.clock!r} is not valid: all robots decide at once here; valid: 'rounds'")
    envs = TeamVecEnv([make_kitchen(get(task), chosen) for _ in range(copies)], sign=sign)
    envs.seed(seed)
    return VecMonitor(envs)


class TeamVecEnv(VecEnv):
    """The robots of some kitchens, the first kitchen's first. Made by `vec_env`.

    Attributes:
        kitchens: the environments.
        robots: (kitchen, robot) of each copy.
        signs: robot -> what stands behind its facts, float32 (sign * robots,).
        render_mode: of all of them.
    """

    def __init__(self, kitchens: Sequence[KitchenParallelEnv], *, sign: int = 0) -> None:
        self.kitchens = list(kitchens)
        self.robots = [(kitchen, name) for kitchen in self.kitchens for name in kitchen.possible_agents]
        names = self.kitchens[-1].possible_agents
        ones = np.eye(len(names), dtype=np.float32).repeat(sign, axis=1)
        self.signs: dict[str, NDArray[np.float32]] = dict(zip(names, ones, strict=True))
        seen, acts = ({name: space(name) for name in names} for space in
                      (self.kitchens[-1].observation_space, self.kitchens[-1].action_space))  # fmt: skip
        self.render_mode = self.kitchens[-1].render_mode
        self._tokens: NDArray[np.int64] = np.zeros(len(self.robots), np.int64)
        super().__init__(len(self.robots), _longer(seen[names[-1]], ones.shape[1]), acts[names[-1]])

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """The seed of the first kitchen's next episode; the others' are the numbers after it."""
        firsts = [None if seed is None else int(seed) + number for number in range(len(self.kitchens))]
        self._next: list[int | None] = list(firsts)
        return [first for first, kitchen in zip(firsts, self.kitchens, strict=True) for _ in kitchen.possible_agents]

    def reset(self) -> Any:
        """Begin an episode in every kitchen; later ones are drawn by the kitchens, from the first one's seed."""
        begun = [kitchen.reset(seed=seed) for kitchen, seed in zip(self.kitchens, self._next, strict=True)]
        self._next = [None] * len(self.kitchens)
        self.reset_infos = [_told(info) for _, infos in begun for info in infos.values()]
        return self._stacked([self._signed(name, row) for seen, _ in begun for name, row in seen.items()])

    def step_async(self, actions: NDArray[Any]) -> None:
        """Take a token for every robot, shape (robots * copies,)."""
        self._tokens = np.asarray(actions)

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Run a round in every kitchen; where an episode ended, begin the next."""
        rows: list[Any] = []
        rewards: list[float] = []
        dones: list[bool] = []
        told: list[dict[str, Any]] = []
        tokens = iter(self._tokens)
        for kitchen in self.kitchens:
            names = kitchen.possible_agents
            seen, paid, ends, cuts, infos = kitchen.step({name: int(next(tokens)) for name in names})
            over = [ends[name] or cuts[name] for name in names]
            own = [_told(infos[name]) for name in names]
            for info, name, done in zip(own, names, over, strict=True):
                info["TimeLimit.truncated"], info["is_success"] = cuts[name] and not ends[name], infos[name]["success"]
                if done:
                    info["terminal_observation"] = self._signed(name, seen[name])
            if all(over):
                seen, begun = kitchen.reset()
                for info, name in zip(own, names, strict=True):
                    info["reset_info"] = _told(begun[name])
            rows += [self._signed(name, seen[name]) for name in names]
            rewards += [paid[name] for name in names]
            dones += over
            told += own
        return self._stacked(rows), np.array(rewards, np.float32), np.array(dones), told

    def close(self) -> None:
        """Close the kitchens."""
        for kitchen in self.kitchens:
            kitchen.close()

    def get_images(self) -> Sequence[Any]:
        """A picture of every kitchen."""
        return [kitchen.render() for kitchen in self.kitchens]

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The attribute of the kitchens in which these robots are."""
        return [getattr(kitchen, attr_name) for kitchen, _ in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set the attribute of the kitchens in which these robots are."""
        for kitchen, _ in self._chosen(indices):
            setattr(kitchen, attr_name, value)

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """What a method says: "action_masks" each robot's mask, bool (N,); others are the kitchens'."""
        if method_name == "action_masks":
            return [kitchen.action_mask(name).astype(bool) for kitchen, name in self._chosen(indices)]
        return [getattr(kitchen, method_name)(*args, **kwargs) for kitchen, _ in self._chosen(indices)]

    def has_attr(self, attr_name: str) -> bool:
        """Whether kitchens have it."""
        return attr_name == "action_masks" or all(hasattr(kitchen, attr_name) for kitchen in self.kitchens)

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """No kitchen is wrapped."""
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: Any) -> list[tuple[KitchenParallelEnv, str]]:
        return [self.robots[index] for index in self._get_indices(indices)]

    def _signed(self, name: str, row: Any) -> Any:
        if isinstance(row, dict):
            return {**row, FACTS: np.concatenate([row[FACTS], self.signs[name]])}
        return np.concatenate([row, self.signs[name]])

    def _stacked(self, rows: Sequence[Any]) -> Any:
        if isinstance(self.observation_space, spaces.Dict):
            return {key: np.stack([row[key] for row in rows]) for key in self.observation_space.spaces}
        return np.stack(rows)


def _longer(space: spaces.Space[Any], more: int) -> spaces.Space[Any]:
    """The space with so many further numbers in 0..1 behind its facts."""
    if isinstance(space, spaces.Dict):
        return spaces.Dict({**space.spaces, FACTS: _longer(space[FACTS], more)})
    (size,) = space.shape or ()
    return spaces.Box(0.0, 1.0, (size + more,), np.float32)


def _told(info: dict[str, Any]) -> dict[str, Any]:
    return {START if key == "episode" else key: value for key, value in info.items()}
