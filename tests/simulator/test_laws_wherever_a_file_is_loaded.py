"""A law of a plant's file acts in environments and in sweeps, as it does in a run."""

from __future__ import annotations

from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

from ves_twin.sweeps.plan import plan_sweep
from ves_twin.sweeps.run_point import run_point

DRAGGED = """schema = 1
base = "ves2_fast"
[[laws]]
place = "arm.q2"
kind = "effort"
of = ["speed@arm.q2"]
knots = [[-1.0, -0.5, 0.0, 0.5, 1.0]]
values = [80.0, 20.0, 0.0, -20.0, -80.0]
"""


@pytest.fixture
def dragged(tmp_path: Path) -> str:
    path = tmp_path / "dragged.toml"
    path.write_text(DRAGGED)
    return str(path)


def test_a_law_acts_in_an_environment(dragged: str):
    seen = []
    for plant in ("ves2_fast", dragged, dragged):
        env = gym.make("ves_twin.envs:VesTwin/VibrationFreeReach-v0", plant=plant)
        env.reset(seed=3)
        action = np.ones(env.action_space.shape)
        for _ in range(5):
            last, *_ = env.step(action)
        seen.append(last)
        env.close()
    assert not np.array_equal(seen[0], seen[1])
    assert np.array_equal(seen[1], seen[2])


def test_a_law_acts_in_a_sweep(dragged: str):
    short = {"run.duration": 1.5, "run.settle": 0.2}
    plan = plan_sweep("identify_fast", [f"plant=ves2_fast,{dragged}"], short)
    plain, lawful = (run_point(point) for point in plan.points)
    assert plain.outcome == lawful.outcome == "completed"
    assert plain.run_hash != lawful.run_hash
