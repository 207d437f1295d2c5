"""The challenge matrix: its sets, its command, and the baselines that came with it."""

import json

import gymnasium as gym
import numpy as np
import pytest
from scipy.optimize import minimize
from short_episodes import make_short

from ves_twin.cli.main import main
from ves_twin.effects.registry import kind_on_ves2
from ves_twin.envs.baselines.lqg import Lqg
from ves_twin.envs.baselines.mpc import HORIZON, Mpc
from ves_twin.envs.challenges import CHALLENGES
from ves_twin.envs.evaluation import NO_RIGS, Trial, evaluate
from ves_twin.envs.rig_set import RigSet
from ves_twin.plant.plant import Plant

DAMPING = "VesTwin/VibrationDamping-v0"
SETS = sorted(set(CHALLENGES.values()) - {NO_RIGS})


@pytest.mark.parametrize("name", SETS)
def test_every_set_gives_rigs_that_stand(name):
    env = make_short(DAMPING)
    rigs = RigSet.load(name)
    drawn = [rigs.draw(Plant.load("ves2_fast"), np.random.default_rng(k)) for k in range(3)]
    assert drawn[0].hash != Plant.load("ves2_fast").hash
    for plant in drawn[:1]:
        _, info = env.reset(seed=0, options={"plant": plant})
        assert info["outcome"] == "running"


def test_what_is_unseen_is_nothing_that_was_trained_with():
    seen, unseen = (
        {kind_on_ves2(drawn.kind).kind for drawn in RigSet.load(name).effects}
        for name in (CHALLENGES["fault seen"], CHALLENGES["fault unseen"])
    )
    assert unseen
    assert not seen & unseen


def test_two_faults_are_two():
    plant = RigSet.load("two-v0").draw(Plant.load("ves2"), np.random.default_rng(0))
    assert len({effect.kind for effect in plant.effects}) == len(plant.effects) == 2


def test_noise_is_that_many_times_the_plant_s_own():
    plant = Plant.load("ves2")
    noisy = RigSet.load("noise-v0").draw(plant, np.random.default_rng(0))
    for name, factor in RigSet.load("noise-v0").times.items():
        values = (p.parameters.array(name) for p in (noisy, plant))
        noisier, own = values
        np.testing.assert_allclose(noisier, factor * own)
    assert noisy.effects == ()


@pytest.mark.slow
def test_one_command_scores_every_challenge_as_evaluate_does(capsys, monkeypatch):
    kept = {}  # the same scores in both forms

    def scored(trial, seeds, *more):
        key = trial, tuple(seeds)
        return kept[key] if key in kept else kept.setdefault(key, evaluate(trial, seeds, *more))

    monkeypatch.setattr("ves_twin.envs.challenges.evaluate", scored)
    words = ["evaluate", "VibrationDamping-v0", "--policy", "still", "--seeds", "1", "--challenges"]
    assert main([*words, "--plant", "ves2_fast", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert list(found) == list(CHALLENGES)
    trial = Trial("VibrationDamping-v0", "still", "delay-v0", "ves2_fast")
    alone = evaluate(trial, [0]).figures["return"].iqm
    assert found["delay"]["figures"]["return"]["iqm"] == alone
    assert len({one["figures"]["return"]["iqm"] for one in found.values()}) == len(CHALLENGES)
    assert main([*words, "--plant", "ves2_fast"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("  ")[1] for line in lines[3:]] == list(CHALLENGES)
    assert len(kept) == len(CHALLENGES)  # both forms ask for the same seeds


@pytest.fixture(scope="module")
def briefing():
    return gym.make(DAMPING, plant="ves2_fast").unwrapped.briefing()


def test_predictive_control_without_a_bound_in_sight_is_lqg(briefing):
    lqg, mpc = Lqg(briefing), Mpc(briefing)
    for seed in range(5):
        state = 1e-4 * np.random.default_rng(seed).standard_normal(39)
        action = lqg.decide(state)
        assert np.max(np.abs(action)) < 1.0
        np.testing.assert_allclose(mpc.decide(state), action, rtol=1e-5, atol=1e-9)


def test_predictive_control_at_the_bounds_is_the_least_cost_there(briefing):
    """Against a general minimiser of the cost, summed step by step."""
    mpc = Mpc(briefing)
    state = np.zeros(39)
    state[:3] = state[12:15] = 0.1
    weight, effort, value = mpc._weights

    def cost(flat):
        total, x = 0.0, state
        for u in flat.reshape(HORIZON, 3):
            total, x = total + u @ effort @ u, mpc._a @ x + mpc._b @ u
            total += x @ weight @ x
        return total + x @ (value - weight) @ x

    best = minimize(cost, np.zeros(3 * HORIZON), method="L-BFGS-B", bounds=[(-1, 1)] * 3 * HORIZON)
    first = mpc.decide(state)
    assert np.max(np.abs(first)) == pytest.approx(1.0)
    np.testing.assert_allclose(first, best.x[:3], atol=0.02)  # the minimiser's own tolerance


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["mpc", "inertial_damper"])
def test_both_damp_more_than_standing_still(policy):
    one, still = (
        evaluate(Trial("VibrationDamping-v0", name, "none", "ves2_fast"), range(100, 102))
        for name in (policy, "still")
    )
    assert one.figures["return"].iqm > still.figures["return"].iqm
    assert set(one.outcomes) == {"completed"}
