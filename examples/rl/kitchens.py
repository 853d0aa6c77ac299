"""What the examples of learning share: kitchens to learn in, and how good a policy is in those that it has not seen."""

import argparse

import gymnasium
import numpy as np

import remac_env  # noqa: F401 - its import registers the environments
from remac_agents.planners.policy_file import Policy, save_policy

SEEN, UNSEEN = range(1_000, 100_000), range(100)
"""Seeds of the episodes to learn from, and of those that are kept for the test."""

STARTS = ("paper", "mixed")


class Kitchens(gymnasium.Wrapper):
    """A task with one robot: any kitchen, style and layout as the seed picks.

    Action: a token. Observation: the facts, and behind them which of `tasks` it is, a 1 among zeros; float32.
    `action_masks()`: what the skill table would not refuse, bool (tokens,). Reward: rounds by which the goal came
    nearer, and 1 for reaching it.
    """

    def __init__(self, task, tasks=(), starts="paper", seed=0):
        super().__init__(
            gymnasium.make(
                f"RemacKitchen-{task}-v0",
                robots=1, backend="symbolic", starts=starts, masks="feasible", reward="distance", obs_format="flat",
            )  # fmt: skip
        )
        self.which = np.array([name == task for name in tasks or (task,)], np.float32)
        size = self.env.observation_space.shape[0] + len(self.which)
        self.observation_space = gymnasium.spaces.Box(0.0, 1.0, (size,), np.float32)
        self.random = np.random.default_rng(seed)

    def reset(self, *, seed=None, options=None):
        chosen = int(self.random.choice(SEEN)) if seed is None or options is None else int(seed)
        facts, info = self.env.reset(seed=chosen)
        return np.concatenate([facts, self.which]), info

    def step(self, action):
        facts, reward, terminated, truncated, info = self.env.step(action)
        info["is_success"] = bool(info["robots"]["robot_0"]["success"])
        return np.concatenate([facts, self.which]), reward, terminated, truncated, info

    def action_masks(self):
        return self.env.unwrapped.action_masks()


def kitchens(tasks, seed=0):
    """Makers of environments: each task with each kind of start."""
    cells = [(task, starts) for task in tasks for starts in STARTS]
    return [
        lambda task=task, starts=starts, number=number: Kitchens(task, tasks, starts, seed=[seed, number])
        for number, (task, starts) in enumerate(cells)
    ]


def export(tasks, layers, activation="tanh"):
    """A trained network as a policy that can be saved; layers: torch.nn.Linear, one after the other."""
    env = gymnasium.make(f"RemacKitchen-{tasks[0]}-v0", robots=1, backend="symbolic")
    arrays = [(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in layers]
    return Policy(
        tasks=tuple(tasks), layers=tuple(arrays), vocabulary=env.unwrapped.vocabulary, masks="feasible", robots=1,
        activation=activation,
    )  # fmt: skip


def successes(policy, task, starts, seeds=UNSEEN):
    """In how many of these episodes the policy reaches the goal, with the best token each time."""
    env, reached = Kitchens(task, policy.tasks, starts), 0
    for seed in seeds:
        seen, info = env.reset(seed=seed, options={})
        over = False
        while not over:
            scores = policy.scores(seen[: -len(policy.tasks)], task)
            action = int(np.where(env.action_masks(), scores, -np.inf).argmax())
            seen, _, terminated, truncated, info = env.step(action)
            over = terminated or truncated
        reached += info["is_success"]
    env.close()
    return reached


def main(learn):
    """The command line of an example: `learn(tasks, steps, seed)` gives a policy, which is saved and tried."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--tasks", default="OpenCabinetPnP", help="names with commas between them")
    parser.add_argument("--steps", type=int, default=43_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", default="policy.npz")
    args = parser.parse_args()
    policy = learn(args.tasks.split(","), args.steps, args.seed)
    save_policy(args.out, policy)
    for task in policy.tasks:
        for starts in STARTS:
            reached = successes(policy, task, starts)
            print(f"{task}, {starts} starts: {reached} of {len(UNSEEN)} unseen episodes reached the goal")
    print("saved", args.out)
