"""Proximal policy optimisation in one file of PyTorch, in the manner of CleanRL.

Needs the extra `train`, for torch alone. The environments share cores by `ChunkedVectorEnv`.

Source: Schulman et al., Proximal Policy Optimization Algorithms, 2017, eqs 7, 9, 11.
"""

from __future__ import annotations

import argparse

import numpy as np
import torch
from torch import nn
from torch.distributions import Normal

from ves_twin.envs.chunked_vector_env import ChunkedVectorEnv

LENGTH, EPOCHS, PARTS = 128, 4, 4
"""Steps between two updates; passes over them; minibatches of a pass."""

GAMMA, LAMBDA, CLIP = 0.98, 0.95, 0.2


class Agent(nn.Module):
    """Gaussian actor and critic, two layers of 64 each."""

    def __init__(self, seen: int, acts: int) -> None:
        super().__init__()

        def net(width: int) -> nn.Sequential:
            hidden = nn.Linear(seen, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh()
            return nn.Sequential(*hidden, nn.Linear(64, width))

        self.mean, self.value = net(acts), net(1)
        self.spread = nn.Parameter(torch.full((acts,), -1.0))

    def policy(self, seen: torch.Tensor) -> Normal:
        return Normal(self.mean(seen), self.spread.exp())


def collect(envs, agent, seen, steps):
    """A roll-out: observations, actions, log-probabilities, rewards, ends; the next observation."""
    rows = []
    for _ in range(steps):
        with torch.no_grad():
            policy = agent.policy(seen)
            action = policy.sample()
            told = policy.log_prob(action).sum(-1)
        following, gain, terminated, truncated, _ = envs.step(action.numpy())
        over = torch.as_tensor(terminated | truncated, dtype=torch.float32)
        rows.append((seen, action, told, torch.as_tensor(gain, dtype=torch.float32), over))
        seen = torch.as_tensor(following)
    return [torch.stack(column) for column in zip(*rows, strict=True)], seen


def advantages(agent, seen, gains, over, last):
    """Generalised advantages (steps, envs), and the returns that the critic is fitted to."""
    with torch.no_grad():
        values = agent.value(torch.cat([seen, last[None]])).squeeze(-1)
    found, running = torch.zeros_like(gains), torch.zeros(gains.shape[1])
    for t in reversed(range(len(gains))):
        kept = 1.0 - over[t]
        error = gains[t] + GAMMA * kept * values[t + 1] - values[t]
        running = error + GAMMA * LAMBDA * kept * running
        found[t] = running
    return found, found + values[:-1]


def update(agent, optimizer, batch):
    seen, action, told, gain, target = (part.flatten(0, 1) for part in batch)
    for _ in range(EPOCHS):
        for index in torch.randperm(len(seen)).chunk(PARTS):
            ratio = (agent.policy(seen[index]).log_prob(action[index]).sum(-1) - told[index]).exp()
            better = (gain[index] - gain[index].mean()) / (gain[index].std() + 1e-8)
            clipped = ratio.clamp(1.0 - CLIP, 1.0 + CLIP)
            loss = -torch.minimum(ratio * better, clipped * better).mean()
            loss = loss + 0.5 * (agent.value(seen[index]).squeeze(-1) - target[index]).pow(2).mean()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimizer.step()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200_000, help="of all environments together")
    parser.add_argument("--envs", type=int, default=8)
    parser.add_argument("--length", type=int, default=LENGTH, help="steps between two updates")
    given = parser.parse_args()
    torch.manual_seed(0)
    torch.set_num_threads(1)
    name = "ves_twin.envs:VesTwin/VibrationDamping-v0"
    envs = ChunkedVectorEnv(name, given.envs, plant="ves2_fast", scaled=True)
    agent = Agent(envs.single_observation_space.shape[0], envs.single_action_space.shape[0])
    optimizer = torch.optim.Adam(agent.parameters(), 3e-4)
    seen = torch.as_tensor(envs.reset(seed=0)[0])
    for turn in range(max(1, given.steps // (given.envs * given.length))):
        batch, seen = collect(envs, agent, seen, given.length)
        gain, target = advantages(agent, batch[0], batch[3], batch[4], seen)
        update(agent, optimizer, [*batch[:3], gain, target])
        print(f"{turn}: mean reward of a step {np.mean(batch[3].numpy()):.5f}", flush=True)
    envs.close()


if __name__ == "__main__":
    main()
