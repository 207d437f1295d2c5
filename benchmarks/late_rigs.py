"""Soft actor-critic against LQG of several tunings, where sensor and valves are late.

Prints the table of docs/challenges.md: VibrationDamping, plant `ves2_fast`, rigs of delay-v0. The
tunings are LQG with other prices of effort, and LQG whose action is smoothed as the network's is.
"""

from __future__ import annotations

import argparse

import gymnasium as gym
import numpy as np

from ves_twin.envs.baselines.lqg import EFFORT, Lqg
from ves_twin.envs.baselines.trained import TrainedDamping
from ves_twin.envs.evaluation import Episode, interquartile_mean, paired, run_episode
from ves_twin.envs.policy import Policy
from ves_twin.envs.rig_env import rig_env
from ves_twin.envs.wrappers import RandomRigs


class SmoothedLqg(Lqg):
    """Lqg whose next action keeps a share of the last; its estimator is told."""

    def __init__(self, briefing, keep: float) -> None:
        super().__init__(briefing)
        self._keep = keep

    def begin(self, observation):
        super().begin(observation)
        self._action = np.zeros(3)

    def act(self, observation):
        wanted = self.decide(self.estimate(observation))
        self._action = self._keep * self._action + (1.0 - self._keep) * wanted
        self.expect(self._action)
        return self._action


def row(name: str, found: list[Episode], trained: list[Episode]) -> str:
    """Return, cost, and what `trained` has more, seed by seed."""
    figure = interquartile_mean(np.array([one.metrics["return"] for one in found]))
    costs = [one.cost for one in found]
    more = paired(trained, found)["return"]
    told = "" if found is trained else f"{more.iqm:+.2f} ({more.low:+.2f} to {more.high:+.2f})"
    return (
        f"| {name} | {figure.iqm:.2f} ({figure.low:.2f} to {figure.high:.2f}) |"
        f" {np.mean(costs):.1f} | {sum(cost > 0.0 for cost in costs)} | {told} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    given = parser.parse_args()
    env = gym.make("ves_twin.envs:VesTwin/VibrationDamping-v0", plant="ves2_fast")
    env = RandomRigs(env, "delay-v0")
    known = rig_env(env).briefing()
    rivals: dict[str, Policy] = {
        f"`lqg`, effort {price:g} J": Lqg(known, price) for price in (EFFORT, 1.0, 3.0)
    }
    rivals |= {
        f"`lqg`, keeps {keep:g} of its action": SmoothedLqg(known, keep) for keep in (0.5, 0.7)
    }
    trained = [run_episode(env, TrainedDamping.build(known), k) for k in range(given.seeds)]
    print("| policy | return | cost | episodes with cost | `trained` has more |")
    print("|---|--:|--:|--:|--:|", row("`trained`", trained, trained), sep="\n", flush=True)
    for name, policy in rivals.items():
        found = [run_episode(env, policy, k) for k in range(given.seeds)]
        print(row(name, found, trained), flush=True)


if __name__ == "__main__":
    main()
