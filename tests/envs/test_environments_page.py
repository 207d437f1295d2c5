"""The page on environments shows the tables that the code has, and a policy that works."""

import re
import subprocess
import sys
from pathlib import Path

import gymnasium as gym
import pytest

from tests.support.told import without_progress
from ves_twin.envs.challenges import CHALLENGES
from ves_twin.envs.evaluation import Trial, evaluate

PAGES = Path(__file__).parents[2] / "docs"
PAGE = (PAGES / "environments.md").read_text(encoding="utf-8")


WITH_TABLES = [
    "VibrationFreeReach",
    "PlatformTracking",
    "AdmittanceTuning",
    "GravityCompensation",
    "MicrogravityCapture",
    "DiagnoseAndRetune",
]


@pytest.mark.parametrize("name", WITH_TABLES)
def test_the_page_has_the_tables_of_the_environments(name):
    u = gym.make(f"VesTwin/{name}-v0").unwrapped
    assert u.observations.table() in PAGE
    assert u.actions.table() in PAGE


def test_damping_is_reach_without_a_goal():
    damping, reach = (
        gym.make(f"VesTwin/{name}-v0").unwrapped
        for name in ("VibrationDamping", "VibrationFreeReach")
    )
    assert set(reach.observations.slices) - set(damping.observations.slices) == {"goal"}
    assert damping.actions.table() == reach.actions.table()


def block(title: str) -> str:
    """The Python block of the page that begins with a comment."""
    (code,) = re.findall(rf"```python\n(# {re.escape(title)}\n.*?)```", PAGE, re.DOTALL)
    return code


@pytest.mark.slow
def test_the_policy_of_the_page_runs_and_damps(tmp_path):
    path = tmp_path / "my_policy.py"
    path.write_text(block("my_policy.py"))
    scores = [
        evaluate(Trial("VibrationDamping-v0", name, "none", "ves2_fast"), range(3))
        .figures["return"]
        .iqm
        for name in (f"{path}:Brake", "still")
    ]
    assert scores[0] > scores[1]


@pytest.mark.slow
@pytest.mark.parametrize(("title", "said"), [("first.py", "'return': -"), ("pushed.py", "[")])
def test_the_short_scripts_of_the_page_run(tmp_path, title, said):
    path = tmp_path / title
    path.write_text(block(title))
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, check=True)
    assert said in done.stdout


def test_the_matrix_on_its_page_is_the_one_of_the_code():
    page = (PAGES / "challenges.md").read_text(encoding="utf-8")
    for challenge, rigs in CHALLENGES.items():
        assert f"| {challenge} | {'' if rigs == 'none' else f'`{rigs}` '}|" in page


@pytest.mark.slow
def test_the_script_of_the_page_shares_environments_out(tmp_path):
    path = tmp_path / "many.py"
    path.write_text(f"{block('many.py')}print(observations.shape, terminated.any())\n")
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True)
    assert (done.stdout, without_progress(done.stderr)) == ("(8, 28) False\n", "")
