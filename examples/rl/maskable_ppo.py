"""MaskablePPO of sb3-contrib learns tasks with one robot in minutes, and saves a policy that plays on the leaderboard.

    python examples/rl/maskable_ppo.py --out policy.npz
"""

import time

import numpy as np
import torch
from kitchens import export, kitchens, main
from sb3_contrib import MaskablePPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor


class Curve(BaseCallback):
    """Prints how the last hundred episodes went."""

    def __init__(self, every):
        super().__init__()
        self.every, self.next, self.ends, self.began = every, every, [], time.process_time()

    def _on_step(self):
        over = zip(self.locals["dones"], self.locals["infos"], strict=True)
        self.ends += [(info["is_success"], info["episode"]["l"]) for done, info in over if done]
        if self.num_timesteps >= self.next and self.ends:
            self.next += self.every
            success, rounds = np.mean(self.ends[-100:], axis=0)
            spent = f"{self.num_timesteps:7d} steps, {time.process_time() - self.began:4.0f} s of a core"
            print(f"{spent}: {success:4.0%} of the last episodes reached the goal, {rounds:4.1f} rounds")
        return True


def learn(tasks, steps, seed=0):
    """The policy after so many steps."""
    torch.set_num_threads(1)
    envs = VecMonitor(DummyVecEnv(kitchens(tasks, seed)))
    model = MaskablePPO(
        "MlpPolicy", envs, n_steps=1024 // envs.num_envs, batch_size=128, n_epochs=5, learning_rate=1e-3, gamma=0.95,
        ent_coef=0.01, policy_kwargs={"net_arch": [64, 64]}, seed=seed, device="cpu",
    )  # fmt: skip
    model.learn(steps, callback=Curve(steps // 20 or 1))
    envs.close()
    hidden = [layer for layer in model.policy.mlp_extractor.policy_net if isinstance(layer, torch.nn.Linear)]
    return export(tasks, [*hidden, model.policy.action_net])


if __name__ == "__main__":
    main(learn)
