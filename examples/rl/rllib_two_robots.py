"""RLlib's new stack: PPO with one network for two robots, and masks; PettingZoo's environment as it is.

    python examples/rl/rllib_two_robots.py --steps 20000

The network chooses each robot's token from that robot's own observation; both get the same reward. How far a
team is from its goal is searched for in every new world, which takes some 70 ms; --reward progress costs nothing, and
pays nothing until a part of the goal is reached.
"""

import argparse

import numpy as np
import torch
from gymnasium import spaces
from kitchens import SEEN, UNSEEN
from pettingzoo.utils import BaseParallelWrapper
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.rl_module.multi_rl_module import MultiRLModuleSpec
from ray.rllib.core.rl_module.rl_module import RLModuleSpec
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule
from ray.tune import register_env

import remac_env


class Team(BaseParallelWrapper):
    """Two robots, with observations in the words of RLlib's module for masks: `observations`, and a float mask."""

    def __init__(self, task, reward="distance"):
        super().__init__(
            remac_env.parallel_env(
                task, robots=2, backend="symbolic", masks="feasible", reward=reward, max_rounds=20
            )
        )
        self.random = np.random.default_rng(0)

    def observation_space(self, agent):
        space = self.env.observation_space(agent)
        mask = spaces.Box(0.0, 1.0, space["action_mask"].shape, np.float32)
        return spaces.Dict({"action_mask": mask, "observations": space["observation"]})

    def reset(self, seed=None, options=None):
        observations, infos = self.env.reset(seed=int(self.random.choice(SEEN)) if seed is None else int(seed))
        return self.renamed(observations), self.shortened(infos)

    def step(self, actions):
        observations, *others, infos = self.env.step(actions)
        return self.renamed(observations), *others, self.shortened(infos)

    def renamed(self, observations):
        return {
            name: {"action_mask": seen["action_mask"].astype(np.float32), "observations": seen["observation"]}
            for name, seen in observations.items()
        }

    def shortened(self, infos):
        return {name: {"success": info["success"]} for name, info in infos.items()}


def learner(task, batch=1024, reward="distance"):
    """The algorithm, which plays in this process."""
    torch.set_num_threads(1)
    register_env("kitchen", lambda config: ParallelPettingZooEnv(Team(task, reward)))
    module = RLModuleSpec(
        module_class=ActionMaskingTorchRLModule, model_config={"head_fcnet_hiddens": [64, 64], "fcnet_hiddens": [64]}
    )
    return (
        PPOConfig()
        .environment("kitchen")
        .env_runners(num_env_runners=0)
        .multi_agent(policies={"robot"}, policy_mapping_fn=lambda *given, **more: "robot")
        .rl_module(rl_module_spec=MultiRLModuleSpec(rl_module_specs={"robot": module}))
        .training(train_batch_size_per_learner=batch, minibatch_size=min(batch, 256), num_epochs=5)
        .training(lr=1e-3, gamma=0.95, entropy_coeff=0.01)
        .build_algo()
    )


def successes(algorithm, task, seeds=UNSEEN):
    """In how many episodes the team reaches the goal, each robot with the best token each time."""
    env, module, reached = Team(task, "sparse"), algorithm.get_module("robot"), 0
    for seed in seeds:
        seen, infos = env.reset(seed=seed)
        while env.agents:
            batch = {
                key: torch.from_numpy(np.stack([seen[name][key] for name in env.agents])) for key in seen["robot_0"]
            }
            with torch.no_grad():
                tokens = module.forward_inference({"obs": batch})["action_dist_inputs"].argmax(-1).tolist()
            seen, *_, infos = env.step(dict(zip(env.agents, tokens, strict=True)))
        reached += infos["robot_0"]["success"]
    return reached


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--task", default="OpenCabinetPnP")
    parser.add_argument("--steps", type=int, default=20_000, help="rounds")
    parser.add_argument("--reward", default="distance")
    args = parser.parse_args()
    algorithm, rounds, turn = learner(args.task, reward=args.reward), 0, 0
    while rounds < args.steps:
        told = algorithm.train()["env_runners"]
        rounds, turn = rounds + told["num_env_steps_sampled"], turn + 1
        if turn % 2 == 0 or rounds >= args.steps:
            gain, length = told["episode_return_mean"] / 2, told["episode_len_mean"]
            print(f"{rounds:7.0f} rounds: return {gain:5.2f} a robot, {length:4.1f} rounds an episode", flush=True)
    reached = successes(algorithm, args.task)
    print(f"{args.task}, two robots: {reached} of {len(UNSEEN)} unseen episodes reached the goal")
    algorithm.stop()


if __name__ == "__main__":
    main()
