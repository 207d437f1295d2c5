"""The trained baseline: what it is shown, that it repeats, and that its score is its own."""

from contextlib import suppress

import gymnasium as gym
import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError
from ves_twin.envs import ENVIRONMENTS, RIG_ENVIRONMENTS
from ves_twin.envs.baselines import BASELINES, EXPERTS, trained
from ves_twin.envs.baselines.arm_features import SIZES, ArmFeatures
from ves_twin.envs.baselines.trained import KEEP, TrainedDamping
from ves_twin.envs.evaluation import Trial, evaluate

ROUND_OFF = 1e-12
"""A few sums of 64 products of size one."""


SCORES = [-10.1339, -9.7052]
"""Returns of seeds 0 and 1 as the command printed them."""
REPEATS = 1e-3
"""J s: a network whose weights changed is off by tenths; round-off of another processor is not."""


@pytest.fixture(scope="module")
def briefing():
    env = gym.make("VesTwin/VibrationDamping-v0", plant="ves2_fast", disable_env_checker=True)
    return env.unwrapped.briefing()


@pytest.fixture(scope="module")
def readings(briefing):
    """Observations anywhere within their bounds, a row a step."""
    table = briefing.observations
    return np.random.default_rng(8).uniform(table.low, table.high, (20, table.width))


def test_features_are_readings_and_their_rates_in_usual_sizes(briefing, readings):
    features = ArmFeatures(briefing)
    features.begin(readings[0])
    features.of(readings[0])
    found = features.of(readings[1]) * SIZES
    first, second = (briefing.observations.split(row) for row in readings[:2])
    np.testing.assert_allclose(found[:6], second["platform.pose"])
    moved = second["platform.pose"] - first["platform.pose"]
    np.testing.assert_allclose(found[6:12], moved / briefing.step)
    np.testing.assert_allclose(found[12:18], second["sensor.wrench"] - second["gravity.estimate"])
    turned = second["arm.command"] - first["arm.command"]
    np.testing.assert_allclose(found[18:21], turned)
    np.testing.assert_allclose(found[21:], turned / briefing.step)


def test_the_network_is_what_its_equation_says(briefing, readings):
    policy, features = TrainedDamping.build(briefing), ArmFeatures(briefing)
    policy.begin(readings[0])
    features.begin(readings[0])
    last = np.zeros(3)
    for row in readings:
        x = features.of(row).tolist()
        for k, (weight, bias) in enumerate(policy._layers):
            x = [
                sum(w * v for w, v in zip(line, x, strict=True)) + b
                for line, b in zip(weight.tolist(), bias.tolist(), strict=True)
            ]
            x = [max(v, 0.0) for v in x] if k < 2 else np.tanh(x)
        last = KEEP * last + (1.0 - KEEP) * np.array(x)
        found = policy.act(row)
        np.testing.assert_allclose(found, last, rtol=0, atol=ROUND_OFF * 100)
        assert np.all(np.abs(found) <= 1.0)


def test_an_episode_leaves_nothing_behind(briefing, readings):
    policy, runs = TrainedDamping.build(briefing), []
    for _ in range(2):
        policy.begin(readings[0])
        runs.append([policy.act(row) for row in readings])
    assert np.array_equal(*runs)


def test_other_tasks_are_refused():
    for name in set(RIG_ENVIRONMENTS) - {"VesTwin/VibrationDamping-v0"}:
        other = gym.make(name, plant="ves2_fast", disable_env_checker=True).unwrapped.briefing()
        with pytest.raises(InvalidInputError, match="VibrationDamping"):
            TrainedDamping.build(other)


def test_a_network_for_other_features_is_refused(briefing, tmp_path, monkeypatch):
    path = tmp_path / "other.npz"
    np.savez(path, weight1=np.zeros((3, 5)), bias1=np.zeros(3))
    monkeypatch.setattr(trained, "find_resource", lambda *words: path)
    with pytest.raises(InvalidInputError, match="5 inputs"):
        TrainedDamping.build(briefing)


@pytest.mark.slow
def test_its_score_is_reproduced():
    """`ves-twin evaluate VibrationDamping-v0 --policy trained --plant ves2_fast --seeds 2`."""
    found, still = (
        evaluate(Trial("VibrationDamping-v0", name, "test-v0", "ves2_fast"), range(2)).episodes
        for name in ("trained", "still")
    )
    returns = [episode.metrics["return"] for episode in found]
    assert returns == pytest.approx(SCORES, abs=REPEATS)
    assert [episode.cost for episode in found] == [0.0, 0.0]
    assert all(r > s.metrics["return"] for r, s in zip(returns, still, strict=True))


@pytest.mark.parametrize("identity", sorted(ENVIRONMENTS))
def test_a_baseline_fits_a_task_or_says_that_it_does_not(identity):
    briefing = gym.make(identity, disable_env_checker=True).unwrapped.briefing()
    fits = set()
    for name, policy in BASELINES.items():
        with suppress(InvalidInputError):
            policy.build(briefing)
            fits.add(name)
    assert {"still", EXPERTS[identity]} <= fits
