"""Four kitchens at the same time, as Gymnasium's vector environment: random commands that the masks allow."""

import gymnasium
import numpy as np

import remac_env  # noqa: F401 - its import registers the environments

if __name__ == "__main__":  # with vectorization_mode="async" each kitchen has a process of its own
    envs = gymnasium.make_vec("RemacKitchen-HeatOnStove-v0", 4, "sync", backend="symbolic", max_rounds=5)
    random = np.random.default_rng(0)
    observations, infos = envs.reset(seed=0)
    for _ in range(20):
        actions = [random.choice(np.flatnonzero(mask)) for mask in observations["robot_0_action_mask"]]
        observations, rewards, terminated, truncated, infos = envs.step(np.array(actions))
    print("observations of", {name: values.shape for name, values in observations.items()})
    envs.close()
