"""Minari data sets: the episodes to the last bit, with hidden faults told in metadata alone."""

import json

import gymnasium as gym
import minari
import numpy as np
import pytest

from ves_twin.cli.main import main
from ves_twin.envs import ENVIRONMENTS, RIG_ENVIRONMENTS
from ves_twin.envs.baselines import BASELINES, EXPERTS
from ves_twin.envs.wrappers import RandomRigs

DAMPING = "VibrationDamping-v0"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    return tmp_path


def made(capsys, *words):
    given = ["dataset", DAMPING, "--plant", "ves2_fast", "--episodes", "2", "--json", *words]
    assert main(given) == 0
    return minari.load_dataset(json.loads(capsys.readouterr().out)["id"])


def test_every_environment_has_an_expert():
    assert set(EXPERTS) == set(ENVIRONMENTS)
    assert set(EXPERTS.values()) <= set(BASELINES)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["expert", "behaviour", "random"])
def test_what_is_read_back_is_the_episode_to_the_last_bit(capsys, kind):
    data = made(capsys, "--kind", kind, "--rigs", "test-v0")
    env = RandomRigs(gym.make(f"VesTwin/{DAMPING}", plant="ves2_fast"), "test-v0")
    for seed, kept in enumerate(data.iterate_episodes()):
        rows, gains = [env.reset(seed=seed)[0]], []
        for action in kept.actions:
            seen, gain, terminated, truncated, _ = env.step(action)
            rows.append(seen)
            gains.append(gain)
        np.testing.assert_array_equal(kept.observations, rows)
        np.testing.assert_array_equal(kept.rewards, gains)
        assert truncated
        assert not terminated
    assert data.id == f"VesTwin/VibrationDamping/{kind}-test-v0"
    (told,) = data.storage.get_episode_metadata([1])
    hidden = [(e.kind, e.target) for e in env.unwrapped.sim.plant.effects]
    assert [(e["kind"], e["target"]) for e in json.loads(told["effects"])] == hidden
    assert hidden


@pytest.mark.nightly
@pytest.mark.parametrize("identity", sorted(ENVIRONMENTS))
def test_a_set_of_every_environment_comes_back_to_the_last_bit(capsys, identity):
    plant = ["--plant", "ves2_fast"] if identity in RIG_ENVIRONMENTS else []
    words = ["dataset", identity, "--kind", "random", "--rigs", "none", "--episodes", "1", *plant]
    assert main([*words, "--json"]) == 0
    data = minari.load_dataset(json.loads(capsys.readouterr().out)["id"])
    env, kept = data.recover_environment(), next(iter(data))
    rows, gains, over = [env.reset(seed=0)[0]], [], False
    for action in kept.actions:
        assert not over
        seen, gain, terminated, truncated, _ = env.step(action)
        rows.append(seen)
        gains.append(gain)
        over = terminated or truncated
    assert over
    np.testing.assert_array_equal(kept.observations, rows)
    np.testing.assert_array_equal(kept.rewards, gains)


@pytest.mark.slow
def test_the_environment_is_recovered_with_its_rigs_and_its_shares(capsys):
    data = made(capsys, "--kind", "random", "--scaled", "--name", "mine/noise-v0")
    env = data.recover_environment()
    kept = next(iter(data))
    assert kept.observations.dtype == kept.actions.dtype == np.float32
    seen, _ = env.reset(seed=0)
    np.testing.assert_array_equal(seen, kept.observations[0])
    np.testing.assert_array_equal(env.step(kept.actions[0])[0], kept.observations[1])


def test_bad_words_are_answered_in_one_line_and_leave_nothing(capsys, folder):
    (folder / "mine" / "taken-v0").mkdir(parents=True)
    for words, answer in (
        (["--kind", "experts"], "did you mean 'expert'"),
        (["--policy", "lgq"], "did you mean 'lqg'"),
        (["--episodes", "0"], "--episodes"),
        (["--name", "mine/taken-v0"], "not there yet"),
        (["--name", "no version!"], "id of Minari"),
        (["--rigs", "tset-v0"], "did you mean 'test-v0'"),
    ):
        assert main(["dataset", DAMPING, "--plant", "ves2_fast", *words]) == 2
        error = capsys.readouterr().err
        assert answer in error
        assert error.count("\n") == 1
    assert [p.name for p in folder.rglob("*")] == ["mine", "taken-v0"]
