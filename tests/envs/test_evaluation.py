"""Scores: interquartile means, policies from files, baselines that do what they are for."""

import json

import gymnasium as gym
import numpy as np
import pytest

from ves_twin.cli.evaluate import UNITS
from ves_twin.cli.main import main
from ves_twin.core.errors import ControllerError, InvalidInputError, UnknownNameError
from ves_twin.envs.baselines import BASELINES
from ves_twin.envs.evaluation import (
    Trial,
    environment_id,
    evaluate,
    interquartile_mean,
    policy_class,
    run_episode,
)
from ves_twin.envs.policy import Policy

POLICY = """
import numpy as np
from ves_twin.envs.policy import Policy

class Mine(Policy):
    @classmethod
    def build(cls, briefing):
        return cls()

    def begin(self, observation):
        self.steps = 0

    def act(self, observation):
        self.steps += 1
        return np.full(3, 0.1 if self.steps < 5 else 0.0)
"""


def test_the_interquartile_mean_leaves_the_outer_quarters_out():
    found = interquartile_mean(np.array([-1000.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1000.0]))
    assert found.iqm == pytest.approx(3.5)
    assert found.low <= found.iqm <= found.high


def test_its_interval_covers_as_often_as_it_says():
    """Normal samples of 20, whose interquartile mean has their mean; percentile intervals of
    small samples cover a little too seldom, 95 % within four sd of 200 trials and 4 % bias."""
    rng = np.random.default_rng(5)
    covered = 0
    for _ in range(200):
        found = interquartile_mean(rng.normal(size=20))
        covered += found.low <= 0.0 <= found.high
    assert 0.95 - 0.04 - 4 * np.sqrt(0.95 * 0.05 / 200) <= covered / 200 <= 1.0


def test_equal_scores_have_no_interval():
    found = interquartile_mean(np.full(5, 2.0))
    assert (found.iqm, found.low, found.high) == (2.0, 2.0, 2.0)


def test_the_command_scores_a_policy_of_a_file(tmp_path, capsys):
    path = tmp_path / "mine.py"
    path.write_text(POLICY)
    words = ["evaluate", "VibrationFreeReach-v0", "--policy", f"{path}:Mine", "--seeds", "2"]
    words += ["--rigs", "none", "--plant", "ves2_fast"]
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [e["seed"] for e in found["episodes"]] == [0, 1]
    assert found["outcomes"] == {"completed": 2}
    returns = [e["metrics"]["return"] for e in found["episodes"]]
    assert found["figures"]["return"]["iqm"] == pytest.approx(np.mean(returns))
    assert set(found["figures"]) - {"return"} <= set(UNITS)
    assert main([*words[:-5], "1", *words[-4:]]) == 0
    text = capsys.readouterr().out
    assert "1 seed\n" in text
    (last,) = (line.split() for line in text.splitlines() if "energy_last [J]" in line)
    assert last[-1] == "-"  # one seed has no interval


def test_bad_words_are_answered_in_one_line(capsys):
    for words, answer in (
        (["Reach-v0", "--policy", "still"], "unknown environment"),
        (["VibrationDamping-v0", "--policy", "stil"], "did you mean 'still'"),
        (["VibrationDamping-v0", "--policy", "still", "--seeds", "0"], "--seeds"),
        (["VibrationDamping-v0", "--policy", "no.py:Mine"], "does not exist"),
        (["VibrationDamping-v0", "--policy", "still", "--workers", "0"], "--workers"),
    ):
        assert main(["evaluate", *words]) == 2
        error = capsys.readouterr().err
        assert answer in error
        assert error.count("\n") == 1


def test_names_of_environments_and_policies():
    assert environment_id("VesTwin/VibrationDamping-v0") == environment_id("VibrationDamping-v0")
    with pytest.raises(UnknownNameError, match="VibrationDamping-v0"):
        environment_id("VibrationDamping-v1")
    assert policy_class("lqg") is BASELINES["lqg"]
    with pytest.raises(InvalidInputError, match="seeds"):
        evaluate(Trial("VibrationDamping-v0", "still", "none", None), [])


def test_a_policy_that_does_not_fit_says_so():
    with pytest.raises(InvalidInputError, match="PlatformTracking"):
        evaluate(Trial("VibrationDamping-v0", "lag_feedforward", "none", "ves2_fast"), [0])
    with pytest.raises(InvalidInputError, match="VibrationFreeReach"):
        evaluate(Trial("PlatformTracking-v0", "straight_path", "none", "ves2_fast"), [0])


class _Fails(Policy):
    def __init__(self, answer):
        self.answer = answer

    def begin(self, observation):
        pass

    def act(self, observation):
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


@pytest.mark.parametrize("answer", [ValueError("no\nroot"), "left", [[0.0], [0.0, 1.0]]])
def test_a_policy_that_fails_is_named_in_one_line(answer):
    env = gym.make("VesTwin/PlatformTracking-v0", plant="ves2_fast", disable_env_checker=True)
    with pytest.raises(ControllerError, match=r"policy _Fails raised ValueError") as caught:
        run_episode(env, _Fails(answer), 0)
    env.close()
    assert "\n" not in str(caught.value)


@pytest.fixture
def score(cases):
    """Figures of a policy in an environment, on rigs of `train-v0`."""
    seeds = range(100, 100 + cases(2))

    def scored(environment, policy):
        found = evaluate(Trial(environment, policy, "train-v0", "ves2_fast"), seeds)
        assert set(found.outcomes) == {"completed"}
        return found.figures

    return scored


@pytest.mark.slow
def test_paths_reach_their_goals_and_planning_pays(score):
    figures = {
        name: score("VibrationFreeReach-v0", name)
        for name in ("straight_path", "hot_spot_path", "planned_path")
    }
    for found in figures.values():
        assert found["goal_error"].iqm < 1e-3  # the servo's integrator holds to counts
    assert figures["planned_path"]["return"].iqm > figures["straight_path"]["return"].iqm


@pytest.mark.slow
def test_control_damps_more_than_standing_still(score):
    still, pped, lqg = (
        score("VibrationDamping-v0", n)["return"].iqm for n in ("still", "pped", "lqg")
    )
    assert lqg > 0.9 * still  # returns are negative
    assert pped > still


@pytest.mark.slow
def test_feedforward_takes_nine_tenths_of_the_lag(score):
    names = ("still", "lag_feedforward")
    still, ahead = (score("PlatformTracking-v0", n)["distance_rms"].iqm for n in names)
    assert ahead < 0.1 * still
