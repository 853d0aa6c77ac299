"""A skill as LeRobot's EnvHub asks for it: upload this file as env.py of a repository on the Hub.

    lerobot-eval --env.type=hub --env.hub_path=you/your-repository --policy.path=...

LeRobot calls `make_env`, and reads observations called `agent_pos` and `pixels`. Change SKILL and OPTIONS as needed.
With control="joints", actions are those of `remac learn record --format lerobot`.
"""

from typing import Any

import gymnasium

import remac_env  # noqa: F401 - its import registers the environments

SKILL = "TurnOn"
OPTIONS: dict[str, Any] = {"target": "faucet", "obs": "state+images", "control": "joints", "image_size": 96}


def make_env(
    n_envs: int = 1, use_async_envs: bool = False, cfg: Any = None
) -> dict[str, dict[int, gymnasium.vector.VectorEnv]]:
    """Suite -> task -> as many environments side by side; each in a process of its own with `use_async_envs`.

    An episode's successor begins in the step that ends it: LeRobot reads successes from `final_info`, which Gymnasium
    gives in this mode alone. `cfg`: what LeRobot knows of the environment; nothing of it is needed.
    """
    vector = gymnasium.vector.AsyncVectorEnv if use_async_envs else gymnasium.vector.SyncVectorEnv
    made = vector([_one for _ in range(n_envs)], autoreset_mode=gymnasium.vector.AutoresetMode.SAME_STEP)
    return {f"RemacSkill-{SKILL}": {0: made}}


def _one() -> gymnasium.Env:
    env = gymnasium.make(f"RemacSkill-{SKILL}-v0", render_mode="rgb_array", **OPTIONS)
    spaces, dictionary = env.observation_space, gymnasium.spaces.Dict
    pixels = dictionary({name: space for name, space in spaces.items() if name != "state"})
    return gymnasium.wrappers.TransformObservation(
        env,
        lambda seen: {"agent_pos": seen["state"], "pixels": {name: seen[name] for name in pixels}},
        dictionary({"agent_pos": spaces["state"], "pixels": pixels}),
    )
