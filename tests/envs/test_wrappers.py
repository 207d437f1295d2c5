"""Wrappers: rigs by episode, mismatch, recordings, delay; vector environments."""

import gymnasium as gym
import numpy as np
import pytest
from short_episodes import make_short, short

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.envs.wrappers import BeliefMismatch, LateObservations, RandomRigs, RecordEpisodes

DAMPING, TRACKING = "VesTwin/VibrationDamping-v0", "VesTwin/PlatformTracking-v0"


def rollout(env, seed, steps=6):
    rng = np.random.default_rng(1)
    rows = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        rows.append(env.step(rng.uniform(-1, 1, env.action_space.shape))[0])
    return np.array(rows)


def test_random_rigs_change_with_the_seed_and_repeat_with_it():
    env = RandomRigs(make_short(TRACKING), "train-v0")
    one, plants = rollout(env, 1), []
    plants.append(env.unwrapped.sim.plant.hash)
    rollout(env, 2)
    plants.append(env.unwrapped.sim.plant.hash)
    np.testing.assert_array_equal(rollout(env, 1), one)
    plants.append(env.unwrapped.sim.plant.hash)
    assert plants[0] == plants[2] != plants[1]
    assert env.unwrapped.sim.plant.fidelity.value == "fast"


def test_belief_mismatch_moves_the_plant_and_not_the_belief():
    env = BeliefMismatch(make_short(DAMPING), {"arm.mass": 1.0})
    env.reset(seed=1)
    masses = env.unwrapped.sim.plant.parameters.array("arm.mass")
    believed = env.unwrapped.briefing().belief.parameters.array("arm.mass")
    assert np.all(masses != believed)
    np.testing.assert_array_equal(believed, vt.Plant.load("ves2").parameters.array("arm.mass"))


def test_mismatch_and_rigs_are_drawn_apart():
    both = RandomRigs(BeliefMismatch(make_short(DAMPING), {"arm.mass": 1.0}), "train-v0")
    both.reset(seed=1)
    plant = both.unwrapped.sim.plant
    alone = BeliefMismatch(make_short(DAMPING), {"arm.mass": 1.0})
    alone.reset(seed=1)
    masses = (p.parameters.array("arm.mass") for p in (plant, alone.unwrapped.sim.plant))
    np.testing.assert_array_equal(*masses)
    assert plant.effects


def test_wrong_wrapping_is_refused_at_once():
    with pytest.raises(UnknownNameError, match=r"arm\.mass"):
        BeliefMismatch(make_short(DAMPING), {"arm.mas": 1.0})
    with pytest.raises(InvalidInputError, match="one of ves_twin"):
        RandomRigs(gym.make("CartPole-v1"), "train-v0")
    with pytest.raises(InvalidInputError, match="steps"):
        LateObservations(make_short(DAMPING), -1)


def test_late_observations_are_the_same_ones_later():
    plain = rollout(make_short(TRACKING), 4)
    late = rollout(LateObservations(make_short(TRACKING), 2), 4)
    np.testing.assert_array_equal(late[2:], plain[:-2])
    np.testing.assert_array_equal(late[:2], plain[[0, 0]])
    np.testing.assert_array_equal(rollout(LateObservations(make_short(TRACKING), 0), 4), plain)


def test_recorded_episodes_are_recordings(tmp_path):
    env = RecordEpisodes(make_short(DAMPING), tmp_path, every=2)
    for seed in (1, 2, 3):
        env.reset(seed=seed)
        over = False
        while not over and seed != 3:
            *_, terminated, truncated, _ = env.step(np.full(3, 0.2))
            over = terminated or truncated
    env.step(np.zeros(3))
    env.close()
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "episode-0001.parquet",
        "episode-0003.parquet",
    ]
    whole = vt.load_recording(tmp_path / "episode-0001.parquet")
    assert whole.info.outcome == "completed"
    assert whole.time[-1] == pytest.approx(1.0, abs=0.07)  # a step
    assert np.max(np.abs(whole["arm.command"][-1] - whole["arm.command"][0])) > 0.05
    # a recorded pose is what the observation said
    left = vt.load_recording(tmp_path / "episode-0003.parquet")
    assert left.info.outcome == "unfinished"
    assert len(left) == 4


def test_a_recording_beside_an_episode_does_not_change_it(tmp_path):
    plain = rollout(make_short(DAMPING), 4)
    np.testing.assert_array_equal(rollout(RecordEpisodes(make_short(DAMPING), tmp_path), 4), plain)


@pytest.mark.slow
def test_rerun_files_are_written_beside_them(tmp_path):
    env = RecordEpisodes(make_short(DAMPING), tmp_path, rrd=True)
    env.reset(seed=0)
    env.step(np.zeros(3))
    env.close()
    assert (tmp_path / "episode-0001.rrd").read_bytes()[:3] == b"RRF"


@pytest.mark.slow
def test_environments_in_processes_equal_single_ones_to_the_last_bit():
    scenario = short("vibration_damping")
    envs = gym.make_vec(
        f"ves_twin.envs:{DAMPING}",
        num_envs=2,
        vectorization_mode="async",
        vector_kwargs={"context": "spawn"},
        plant="ves2_fast",
        scenario=scenario,
    )
    rng = np.random.default_rng(1)
    try:
        rows = [envs.reset(seed=[4, 9])[0]]
        actions = rng.uniform(-1, 1, (6, 3))
        rows += [envs.step(np.stack([action, action]))[0] for action in actions]
    finally:
        envs.close()
    found = np.array(rows)
    for k, seed in enumerate((4, 9)):
        np.testing.assert_array_equal(found[:, k], rollout(make_short(DAMPING), seed))
