"""PPO with nothing but torch, in one loop that can be read from top to bottom; masks, and kitchens side by side.

    python examples/rl/ppo_in_torch.py --out policy.npz
"""

import time

import numpy as np
import torch
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from kitchens import export, kitchens, main
from torch import nn

ROUNDS, EPOCHS, BATCH = 256, 5, 128
"""Rounds of each kitchen between two updates; how often each is learnt from, and how many at a time."""

GAMMA, LAMBDA, CLIP, ENTROPY, RATE = 0.95, 0.95, 0.2, 0.01, 1e-3


def network(inputs, outputs):
    return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs))


def choices(actor, seen, masks):
    """What to do, as a distribution over the tokens that the masks allow."""
    return torch.distributions.Categorical(logits=actor(seen).masked_fill(~masks, -1e8))


def advantages(rewards, values, last, over):
    """Generalised advantage estimates; all of shape (rounds, kitchens), `last` of (kitchens,)."""
    estimates, running = torch.zeros_like(rewards), torch.zeros_like(last)
    for at in reversed(range(len(rewards))):
        after = last if at == len(rewards) - 1 else values[at + 1]
        going_on = 1.0 - over[at]
        running = rewards[at] + GAMMA * after * going_on - values[at] + GAMMA * LAMBDA * going_on * running
        estimates[at] = running
    return estimates


def collect(envs, actor, critic, seen, ends):
    """Play ROUNDS in each kitchen. Returns what was seen, allowed, chosen, how likely that was, and what came of it."""
    kept = {name: [] for name in ("seen", "masks", "actions", "chances", "rewards", "values", "over")}
    for _ in range(ROUNDS):
        masks = torch.from_numpy(np.stack(envs.call("action_masks")))
        with torch.no_grad():
            choice = choices(actor, seen, masks)
            actions, value = choice.sample(), critic(seen)[:, 0]
        now, rewards, terminated, truncated, infos = envs.step(actions.numpy())
        over = terminated | truncated
        ends += [bool(infos["final_info"]["is_success"][number]) for number in np.flatnonzero(over)]
        row = seen, masks, actions, choice.log_prob(actions), torch.tensor(rewards).float(), value
        for name, part in zip(kept, (*row, torch.from_numpy(over).float()), strict=True):
            kept[name].append(part)
        seen = torch.from_numpy(now)
    return {name: torch.stack(parts) for name, parts in kept.items()}, seen


def update(actor, critic, optimiser, kept, gains):
    """PPO's clipped loss, the error of the values, and a little for keeping choices open."""
    flat = {name: part.flatten(0, 1) for name, part in kept.items()}
    returns, gains = (gains + kept["values"]).flatten(), gains.flatten()
    for _ in range(EPOCHS):
        for rows in torch.randperm(len(gains)).split(BATCH):
            choice = choices(actor, flat["seen"][rows], flat["masks"][rows])
            ratio = (choice.log_prob(flat["actions"][rows]) - flat["chances"][rows]).exp()
            gain = (gains[rows] - gains[rows].mean()) / (gains[rows].std() + 1e-8)
            bounded = torch.minimum(ratio * gain, ratio.clamp(1 - CLIP, 1 + CLIP) * gain).mean()
            error = (critic(flat["seen"][rows])[:, 0] - returns[rows]).pow(2).mean()
            loss = 0.5 * error - bounded - ENTROPY * choice.entropy().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_([*actor.parameters(), *critic.parameters()], 0.5)
            optimiser.step()


def learn(tasks, steps, seed=0):
    """The policy after so many steps."""
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    envs = SyncVectorEnv(kitchens(tasks, seed), autoreset_mode=AutoresetMode.SAME_STEP)
    inputs, tokens = envs.single_observation_space.shape[0], int(envs.single_action_space.n)
    actor, critic, ends, done = network(inputs, tokens), network(inputs, 1), [], 0
    optimiser = torch.optim.Adam([*actor.parameters(), *critic.parameters()], lr=RATE)
    seen, began = torch.from_numpy(envs.reset()[0]), time.process_time()
    while done < steps:
        kept, seen = collect(envs, actor, critic, seen, ends)
        with torch.no_grad():
            last = critic(seen)[:, 0]
        update(actor, critic, optimiser, kept, advantages(kept["rewards"], kept["values"], last, kept["over"]))
        done += kept["rewards"].numel()
        if done * 20 // steps > (done - kept["rewards"].numel()) * 20 // steps:
            spent = f"{done:7d} steps, {time.process_time() - began:4.0f} s of a core"
            print(f"{spent}: {np.mean(ends[-100:] or [0]):4.0%} of the last episodes reached the goal")
    envs.close()
    return export(tasks, [layer for layer in actor if isinstance(layer, nn.Linear)])


if __name__ == "__main__":
    main(learn)
