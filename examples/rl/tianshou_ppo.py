"""Tianshou: PPO with masks, one robot, any kitchen.

    python examples/rl/tianshou_ppo.py --steps 26000
"""

import argparse
import time

import gymnasium
import numpy as np
import torch
from gymnasium import spaces
from kitchens import UNSEEN, Kitchens
from tianshou.algorithm import PPO
from tianshou.algorithm.modelfree.reinforce import DiscreteActorPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Batch, Collector, CollectStats, VectorReplayBuffer
from tianshou.env import DummyVectorEnv
from tianshou.trainer import OnPolicyTrainerParams
from torch import nn

ROUNDS, EPOCHS, BATCH = 1024, 5, 128
"""Rounds between two updates; how often each is learnt from, and how many at a time."""


class Masked(gymnasium.Wrapper):
    """A kitchen whose observations carry their mask; `ends` takes in whether each episode reached its goal."""

    def __init__(self, env, ends):
        super().__init__(env)
        self.ends = ends
        self.observation_space = spaces.Dict(
            {"obs": env.observation_space, "mask": spaces.Box(0, 1, (int(env.action_space.n),), np.int8)}
        )

    def reset(self, **given):
        seen, _ = self.env.reset(**given)
        return self.masked(seen), {}

    def step(self, action):
        seen, reward, terminated, truncated, info = self.env.step(action)
        if terminated or truncated:
            self.ends.append(info["is_success"])
        return self.masked(seen), reward, terminated, truncated, {}

    def masked(self, seen):
        return {"obs": seen, "mask": self.env.action_masks().astype(np.int8)}


class Network(nn.Module):
    """Scores of the tokens, with masks: those that are not allowed have none; or, of one output, the value."""

    def __init__(self, inputs, outputs):
        super().__init__()
        self.layers = nn.Sequential(
            nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs)
        )
        self.value = outputs == 1

    def forward(self, seen, state=None, info=None):
        scores = self.layers(torch.as_tensor(seen.obs))
        if self.value:
            return scores
        return scores.masked_fill(torch.as_tensor(seen.mask) == 0, -1e8), state


def learn(task, steps, seed=0):
    """The policy after so many steps."""
    torch.manual_seed(seed)
    np.random.seed(seed)  # noqa: NPY002 - Tianshou shuffles with NumPy's own generator
    torch.set_num_threads(1)
    ends, one = [], Kitchens(task)
    envs = DummyVectorEnv([lambda n=n: Masked(Kitchens(task, seed=[seed, n]), ends) for n in range(4)])
    inputs, tokens = one.observation_space.shape[0], int(one.action_space.n)
    policy = DiscreteActorPolicy(actor=Network(inputs, tokens), action_space=one.action_space, deterministic_eval=True)
    algorithm = PPO(
        policy=policy, critic=Network(inputs, 1), optim=AdamOptimizerFactory(lr=1e-3), max_grad_norm=0.5, gamma=0.95
    )
    collector = Collector[CollectStats](
        algorithm, envs, VectorReplayBuffer(2 * ROUNDS, 4), raise_on_nan_in_buffer=False
    )
    collector.reset()
    rounds = min(ROUNDS, steps)
    algorithm.run_training(
        OnPolicyTrainerParams(
            training_collector=collector, max_epochs=1, epoch_num_steps=steps, collection_step_num_env_steps=rounds,
            update_step_num_repetitions=EPOCHS, batch_size=BATCH, show_progress=False,
            training_fn=Curve(ends, every=max(1, steps // 15)).tell,
        )  # fmt: skip
    )
    return policy


class Curve:
    """Prints every so many steps how the last hundred episodes went."""

    def __init__(self, ends, every):
        self.ends, self.every, self.next, self.began = ends, every, every, time.process_time()

    def tell(self, epoch, steps):
        if steps >= self.next and self.ends:
            spent = f"{steps:7d} steps, {time.process_time() - self.began:4.0f} s of a core"
            print(f"{spent}: {np.mean(self.ends[-100:]):4.0%} of the last episodes reached the goal", flush=True)
            self.next += self.every


def successes(policy, task, seeds=UNSEEN):
    """In how many of these episodes the policy reaches the goal, with the best token each time."""
    env = Masked(Kitchens(task), ends=[])
    policy.eval()
    for seed in seeds:
        (seen, _), over = env.reset(seed=seed, options={}), False
        while not over:
            rows = Batch(obs=seen["obs"][None], mask=seen["mask"][None])
            with torch.no_grad():
                token = int(policy(Batch(obs=rows, info={})).act[0])
            seen, _, terminated, truncated, _ = env.step(token)
            over = terminated or truncated
    return sum(env.ends)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--task", default="OpenCabinetPnP")
    parser.add_argument("--steps", type=int, default=26_000)
    args = parser.parse_args()
    reached = successes(learn(args.task, args.steps), args.task)
    print(f"{args.task}, paper starts: {reached} of {len(UNSEEN)} unseen episodes reached the goal")
