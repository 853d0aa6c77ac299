"""Tianshou: double DQN with masks, one robot, any kitchen.

    python examples/rl/tianshou_dqn.py --steps 40000
"""

import argparse

import gymnasium
import numpy as np
import torch
from gymnasium import spaces
from kitchens import SEEN, UNSEEN, Kitchens
from tianshou.algorithm import DQN
from tianshou.algorithm.modelfree.dqn import DiscreteQLearningPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Batch, Collector, CollectStats, VectorReplayBuffer
from tianshou.env import DummyVectorEnv
from tianshou.trainer import OffPolicyTrainerParams
from tianshou.utils.net.common import Net
from torch import nn


class Masked(gymnasium.Wrapper):
    """A kitchen with observations as Tianshou's DQN takes them: `obs`, and the mask with them."""

    def __init__(self, env):
        super().__init__(env)
        self.observation_space = spaces.Dict(
            {"obs": env.observation_space, "mask": spaces.Box(0, 1, (int(env.action_space.n),), np.int8)}
        )

    def reset(self, **given):
        seen, _ = self.env.reset(**given)
        return self.masked(seen), {}

    def step(self, action):
        seen, reward, terminated, truncated, info = self.env.step(action)
        return self.masked(seen), reward, terminated, truncated, {"is_success": info["is_success"]}

    def masked(self, seen):
        return {"obs": seen, "mask": self.env.action_masks().astype(np.int8)}


class Inner(nn.Module):
    """A network that takes its observation out of the dict."""

    def __init__(self, net):
        super().__init__()
        self.net = net

    def forward(self, obs, state=None, info=None):
        return self.net(obs.obs if hasattr(obs, "obs") else obs, state)


def learn(task, steps, seed=0):
    """The policy after so many steps."""
    torch.manual_seed(seed)
    np.random.seed(seed)  # noqa: NPY002 - Tianshou explores with NumPy's own generator
    torch.set_num_threads(1)
    envs = DummyVectorEnv([lambda n=n: Masked(Kitchens(task, seed=[seed, n])) for n in range(4)])
    one = Masked(Kitchens(task))
    size, tokens = one.observation_space["obs"].shape, int(one.action_space.n)
    net = Inner(Net(state_shape=size, action_shape=tokens, hidden_sizes=[64, 64]))
    policy = DiscreteQLearningPolicy(model=net, action_space=one.action_space, eps_training=0.1)
    algorithm = DQN(
        policy=policy, optim=AdamOptimizerFactory(lr=1e-3), gamma=0.95, n_step_return_horizon=3, target_update_freq=250
    )
    collector = Collector[CollectStats](
        algorithm, envs, VectorReplayBuffer(20_000, 4), exploration_noise=True, raise_on_nan_in_buffer=False
    )
    collector.reset()
    collector.collect(n_step=min(steps, 1000))
    algorithm.run_training(
        OffPolicyTrainerParams(
            training_collector=collector, max_epochs=1, epoch_num_steps=steps,
            # Tianshou looks through its whole buffer for NaN after each collection.
            collection_step_num_env_steps=200, update_step_num_gradient_steps_per_sample=0.2, batch_size=64,
            show_progress=False, training_fn=Curve(policy, task, every=max(1, steps // 10)).tell,
        )  # fmt: skip
    )
    return policy


class Curve:
    """Prints every so many steps how often the policy, with its best token each time, reaches the goal."""

    def __init__(self, policy, task, every):
        self.policy, self.task, self.every, self.next = policy, task, every, every

    def tell(self, epoch, steps):
        if steps >= self.next:
            reached = successes(self.policy, self.task, SEEN[:20])
            print(f"{steps:7d} steps: {reached} of 20 episodes of the training reached the goal", flush=True)
            self.next += self.every


def successes(policy, task, seeds=UNSEEN):
    """In how many of these episodes the policy reaches the goal, with the best token each time."""
    env, reached = Masked(Kitchens(task)), 0
    policy.eval()
    for seed in seeds:
        (seen, info), over = env.reset(seed=seed, options={}), False
        while not over:
            rows = Batch(obs=seen["obs"][None], mask=seen["mask"][None])
            with torch.no_grad():
                token = int(policy(Batch(obs=rows, info={})).act[0])
            seen, _, terminated, truncated, info = env.step(token)
            over = terminated or truncated
        reached += info["is_success"]
    return reached


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--task", default="OpenCabinetPnP")
    parser.add_argument("--steps", type=int, default=40_000)
    args = parser.parse_args()
    reached = successes(learn(args.task, args.steps), args.task)
    print(f"{args.task}, paper starts: {reached} of {len(UNSEEN)} unseen episodes reached the goal")
