"""A skill as LeRobot's EnvHub asks for it: upload this file as env.py of a repository on the Hub.

    lerobot-eval --env.type=hub --env.hub_path=you/your-repository --policy.path=...

LeRobot calls `make_env`, and reads observations called `agent_pos` and `pixels`. Change SKILL and OPTIONS as needed.
"""

from typing import Any

import gymnasium

import remac_env  # noqa: F401 - its import registers the environments

SKILL = "TurnOn"
OPTIONS: dict[str, Any] = {"target": "faucet", "obs": "state+images", "control": "ee", "image_size": 96}


def make_env(n_envs: int = 1, use_async_envs: bool = False) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
    """Suite -> task -> as many environments side by side; each in a process of its own with `use_async_envs`."""
    vector = gymnasium.vector.AsyncVectorEnv if use_async_envs else gymnasium.vector.SyncVectorEnv
    return {f"RemacSkill-{SKILL}": {0: vector([_one for _ in range(n_envs)])}}


def _one() -> gymnasium.Env:
    env = gymnasium.make(f"RemacSkill-{SKILL}-v0", render_mode="rgb_array", **OPTIONS)
    spaces, dictionary = env.observation_space, gymnasium.spaces.Dict
    pixels = dictionary({name: space for name, space in spaces.items() if name != "state"})
    return gymnasium.wrappers.TransformObservation(
        env,
        lambda seen: {"agent_pos": seen["state"], "pixels": {name: seen[name] for name in pixels}},
        dictionary({"agent_pos": spaces["state"], "pixels": pixels}),
    )
