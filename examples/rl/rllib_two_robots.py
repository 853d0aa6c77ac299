"""RLlib's new stack: PPO with one network for two robots, and masks; PettingZoo's environment as it is.

    python examples/rl/rllib_two_robots.py --steps 18000

One network chooses each robot's token from that robot's own observation; both get the same reward. It is `nearest`,
which pays a right step of either robot when it is made. `distance` pays a team only for rounds in which both do the
right thing at once, which hardly ever happens to robots that have learnt nothing, and takes seven times as long.
"""

import argparse
import time

import numpy as np
import torch
from gymnasium import spaces
from kitchens import SEEN, UNSEEN
from pettingzoo.utils import BaseParallelWrapper
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.callbacks.callbacks import RLlibCallback
from ray.rllib.core.rl_module.multi_rl_module import MultiRLModuleSpec
from ray.rllib.core.rl_module.rl_module import RLModuleSpec
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.rllib.examples.rl_modules.classes.action_masking_rlm import ActionMaskingTorchRLModule
from ray.tune import register_env

import remac_env

SIGN = 64
"""How often it stands in an observation which robot it is: once among 6,299 facts moves the network too little."""


class Team(BaseParallelWrapper):
    """Two robots, with observations in the words of RLlib's module for masks: `observations`, and a float mask.

    Behind the facts stands which robot it is, ones among zeros: at the start both see the same, and with one network
    and no such sign, or a faint one, both learn to draw lots, and with their best tokens want the same place for ever.
    """

    def __init__(self, task, reward="nearest"):
        super().__init__(
            remac_env.parallel_env(
                task, robots=2, backend="symbolic", masks="feasible", reward=reward, max_rounds=16
            )
        )
        self.random = np.random.default_rng(0)

    def observation_space(self, agent):
        space = self.env.observation_space(agent)
        mask = spaces.Box(0.0, 1.0, space["action_mask"].shape, np.float32)
        facts = spaces.Box(0.0, 1.0, (space["observation"].shape[0] + SIGN * len(self.possible_agents),), np.float32)
        return spaces.Dict({"action_mask": mask, "observations": facts})

    def reset(self, seed=None, options=None):
        observations, infos = self.env.reset(seed=int(self.random.choice(SEEN)) if seed is None else int(seed))
        return self.renamed(observations), self.shortened(infos)

    def step(self, actions):
        observations, *others, infos = self.env.step(actions)
        return self.renamed(observations), *others, self.shortened(infos)

    def renamed(self, observations):
        signs = np.eye(len(self.possible_agents), dtype=np.float32).repeat(SIGN, axis=1)
        which = dict(zip(self.possible_agents, signs, strict=True))
        return {
            name: {
                "action_mask": seen["action_mask"].astype(np.float32),
                "observations": np.concatenate([seen["observation"], which[name]]),
            }
            for name, seen in observations.items()
        }

    def shortened(self, infos):
        return {name: {"success": info["success"]} for name, info in infos.items()}


class Success(RLlibCallback):
    """Has RLlib count how many of the last hundred episodes reached the goal."""

    def on_episode_end(self, *, episode, metrics_logger, **more):
        won = any(info["success"] for info in episode.get_infos(-1).values())
        metrics_logger.log_value("success", float(won), reduce="mean", window=100)


def learner(task, batch=512, reward="nearest", steps=18_000):
    """The algorithm, which plays in this process, and is surer of itself the nearer it comes to so many rounds."""
    torch.set_num_threads(1)
    register_env("kitchen", lambda config: ParallelPettingZooEnv(Team(task, reward)))
    layers = {"fcnet_hiddens": [64], "head_fcnet_hiddens": [64], "head_fcnet_activation": "tanh"}
    module = RLModuleSpec(module_class=ActionMaskingTorchRLModule, model_config=layers)
    return (
        PPOConfig()
        .environment("kitchen")
        .env_runners(num_env_runners=0)
        .callbacks(Success)
        .multi_agent(policies={"robot"}, policy_mapping_fn=lambda *given, **more: "robot")
        .rl_module(rl_module_spec=MultiRLModuleSpec(rl_module_specs={"robot": module}))
        # A round is two rows of a batch, one for each robot.
        .training(train_batch_size_per_learner=batch, minibatch_size=min(batch, 128), num_epochs=8)
        .training(lr=[[0, 1e-3], [steps, 3e-4]], entropy_coeff=[[0, 0.01], [steps, 0.0]])
        .training(gamma=0.95, lambda_=0.95, grad_clip=0.5)
        .training(clip_param=0.2, use_kl_loss=False, vf_loss_coeff=0.5, vf_clip_param=1e6)
        .debugging(seed=0)
        .build_algo()
    )


def successes(algorithm, task, seeds=UNSEEN, best=False):
    """In how many episodes the team reaches the goal: each robot draws from its chances, as in training, or takes its
    best token each time (`best`)."""
    env, module, reached = Team(task, "sparse"), algorithm.get_module("robot"), 0
    torch.manual_seed(0)
    for seed in seeds:
        seen, _ = env.reset(seed=seed)
        while env.agents:
            batch = {
                key: torch.from_numpy(np.stack([seen[name][key] for name in env.agents]))
                for key in ("action_mask", "observations")
            }
            with torch.no_grad():
                scores = module.forward_inference({"obs": batch})["action_dist_inputs"]
            tokens = scores.argmax(-1) if best else torch.distributions.Categorical(logits=scores).sample()
            seen, *_, infos = env.step(dict(zip(env.agents, tokens.tolist(), strict=True)))
        reached += infos["robot_0"]["success"]
    return reached


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--task", default="OpenCabinetPnP")
    parser.add_argument("--steps", type=int, default=18_000, help="rounds")
    parser.add_argument("--reward", default="nearest")
    parser.add_argument("--unseen", type=int, default=UNSEEN.start, help="first of the 100 seeds of the test")
    args = parser.parse_args()
    began, rounds, turn = time.process_time(), 0, 0
    algorithm = learner(args.task, reward=args.reward, steps=args.steps)
    while rounds < args.steps:
        told = algorithm.train()["env_runners"]
        rounds, turn = rounds + told["num_env_steps_sampled"], turn + 1
        if turn % 3 == 0 or rounds >= args.steps:
            spent = f"{rounds:7.0f} rounds, {time.process_time() - began:4.0f} s of a core"
            gain, length = told["episode_return_mean"] / 2, told["episode_len_mean"]
            won = f"{told['success']:4.0%} of the last episodes reached the goal"
            print(f"{spent}: {won}, return {gain:5.2f}, {length:4.1f} rounds", flush=True)
    unseen = range(args.unseen, args.unseen + 100)
    drawn, best = (successes(algorithm, args.task, unseen, best=best) for best in (False, True))
    print(f"{args.task}, two robots: {drawn} of 100 unseen episodes reached the goal, {best} by best tokens alone")
    algorithm.stop()


if __name__ == "__main__":
    main()
