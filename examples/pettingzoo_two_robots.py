"""Two robots in PettingZoo: random commands that the masks allow."""

import numpy as np

import remac_env

env = remac_env.parallel_env("OpenMicrowavePnP", robots=2, backend="symbolic", max_rounds=8)
random = np.random.default_rng(0)
observations, infos = env.reset(seed=0)
while env.agents:
    actions = {name: random.choice(np.flatnonzero(observations[name]["action_mask"])) for name in env.agents}
    observations, rewards, terminations, truncations, infos = env.step(actions)
    for name, info in infos.items():
        print(name, env.vocabulary.decode(actions[name]), "->", info["outcome"]["status"])
print("rounds", infos["robot_0"]["round"], "truncated", truncations["robot_0"])
env.close()
