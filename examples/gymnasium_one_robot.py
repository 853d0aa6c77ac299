"""One robot in Gymnasium: a list of commands, one a step."""

import gymnasium

import remac_env  # noqa: F401 - its import registers the environments

PLAN = ["navigate to pan", "pick up pan", "navigate to stove", "place to stove", "navigate to vegetable"]
PLAN += ["pick up vegetable", "navigate to pan", "place to pan", "turn on stove"]

env = gymnasium.make("RemacKitchen-HeatOnStove-v0", backend="symbolic")  # backend="physics": MuJoCo decides
observation, info = env.reset(seed=0)
for command in PLAN:
    action = env.unwrapped.vocabulary.encode(command)
    observation, reward, terminated, truncated, info = env.step(action)
    print(command, "->", info["robots"]["robot_0"]["outcome"]["status"])
print("reward", reward, "terminated", terminated)
env.close()
