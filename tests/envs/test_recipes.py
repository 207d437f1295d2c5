"""The recipes for others' learners run, where the extra `train` is installed."""

import subprocess
import sys
from pathlib import Path

import pytest

RECIPES = Path(__file__).parents[2] / "benchmarks" / "recipes"

WORDS = {
    "sac_stable_baselines3": ["--steps", "260", "--envs", "2", "--episodes", "1"],
    "sac_on_lqg": ["--steps", "20", "--every", "20"],
    "ppo_one_file": ["--steps", "128", "--envs", "2", "--length", "32"],
}

SAID = {
    "sac_stable_baselines3": "return on test-v0",
    "sac_on_lqg": "return more than lqg",
    "ppo_one_file": "1: mean reward",
}

WITHOUT = "recipes were not run: the extra 'train' is not installed (pip install '.[train]')"


def test_every_recipe_is_tried():
    assert {path.stem for path in RECIPES.glob("*.py")} == set(WORDS)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(WORDS))
def test_a_recipe_runs(name, tmp_path):
    pytest.importorskip("stable_baselines3", reason=WITHOUT)
    words = [sys.executable, str(RECIPES / f"{name}.py"), *WORDS[name]]
    out = ["--out", str(tmp_path / "net.zip")] if name.startswith("sac") else []
    done = subprocess.run([*words, *out], capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr
    assert SAID[name] in done.stdout
