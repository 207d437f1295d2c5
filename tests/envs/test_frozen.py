"""A version of an id stands for one behaviour: a hash over a rounded trajectory of each."""

import hashlib

import gymnasium as gym
import numpy as np
import pytest

from ves_twin.effects.registry import RENAMED
from ves_twin.envs import RIG_ENVIRONMENTS
from ves_twin.envs.rig_set import RigSet
from ves_twin.plant.plant import Plant

GRID = 1e-5
"""Observations are rounded to this share of their range, rewards to this share of WORST times a
step: a hundred thousand times the round-off of another processor, a tenth of what one per cent
of a rod's mass changes."""

FROZEN = {
    "VesTwin/AdmittanceTuning-v0": "3521d6c0049a5ce1",
    "VesTwin/GravityCompensation-v0": "c647528a99cf381b",
    "VesTwin/MicrogravityCapture-v0": "5a1f949206958e51",
    "VesTwin/PlatformTracking-v0": "98424a970e12b3d7",
    "VesTwin/VibrationDamping-v0": "92ab3598e761f140",
    "VesTwin/VibrationFreeReach-v0": "53be4ab51895f37e",
}
"""Change a plant, a scenario or a reward, and an id becomes -v1, with a hash of its own."""

RETUNING = "9251bbc8d93beff6"
"""Of VesTwin/DiagnoseAndRetune-v0."""

RIGS = {
    "train-v0": "28cd4ddf4daa762d",
    "test-v0": "02a013b7f5cd750f",
    "valves-v0": "e53683f54c7306ab",
    "delay-v0": "079da759a28a7bbe",
    "noise-v0": "9e8e79303259aa1a",
    "unseen-v0": "c95234855c5adf04",
    "two-v0": "9eb5cbb40b762a2d",
    "drift-v0": "9973d282645319ca",
    "limits-v0": "fff7c2e8e6981109",
    "payloads-v0": "5750f31322e71415",
}
"""The same for the sets of rigs."""

STEPS = 24


def trajectory_hash(identity, plant=None, nudge=0.0):
    env = gym.make(identity, plant=plant)
    u = env.unwrapped
    seen, _ = env.reset(seed=0)
    u.sim.data.qpos[u.sim.rig.layout.platform_qpos] += nudge
    rows = [seen]
    gains = []
    for k in range(STEPS):
        phase = 0.7 * k + np.arange(u.actions.width)
        seen, gain, *_ = env.step(0.3 * np.sin(phase))
        rows.append(seen)
        gains.append(gain)
    span = u.observation_space.high - u.observation_space.low
    counts = np.rint(np.array(rows) / span / GRID).astype(np.int64)
    pay = np.rint(np.array(gains) / (u.WORST * u.span) / GRID).astype(np.int64)
    return hashlib.sha256(counts.tobytes() + pay.tobytes()).hexdigest()[:16]


@pytest.mark.parametrize("identity", sorted(RIG_ENVIRONMENTS))
def test_the_environment_is_what_its_version_says(identity):
    assert trajectory_hash(identity) == FROZEN[identity], "a new behaviour needs a new version"


def retuning_hash():
    """The same of three trials without a rig; the return is rounded to 1e-5 of a thousand."""
    env = gym.make("VesTwin/DiagnoseAndRetune-v0", experiments=2).unwrapped
    rows, gains = [env.reset(seed=0)[0]], []
    for k in range(3):
        seen, gain, *_ = env.step(0.3 * np.sin(0.7 * k + np.arange(env.actions.width)))
        rows.append(seen)
        gains.append(gain)
    span = env.observation_space.high - env.observation_space.low
    counts = np.rint(np.array(rows) / span / GRID).astype(np.int64)
    pay = np.rint(np.array(gains) / 1e3 / GRID).astype(np.int64)
    return hashlib.sha256(counts.tobytes() + pay.tobytes()).hexdigest()[:16]


def test_retuning_is_what_its_version_says():
    assert retuning_hash() == RETUNING, "a new behaviour needs a new version"


def test_a_changed_plant_is_noticed():
    heavier = Plant.load("ves2").with_values({"arm.mass": [54.5, 12.8, 17.5, 9.0]})
    identity = "VesTwin/VibrationDamping-v0"
    assert trajectory_hash(identity, heavier) != FROZEN[identity]


def test_round_off_is_not_noticed():
    """A platform 1e-13 m aside stands for another processor's arithmetic."""
    identity = "VesTwin/VibrationDamping-v0"
    assert trajectory_hash(identity, nudge=1e-13) == FROZEN[identity]


@pytest.mark.parametrize("name", sorted(RIGS))
def test_the_set_of_rigs_is_what_its_version_says(name):
    """Twenty draws, each number to six digits; kinds by their names when the set was frozen."""
    digest = hashlib.sha256()
    then = {(k, t): name for name, (k, targets) in RENAMED.items() for t in targets}
    for seed in range(20):
        plant = RigSet.load(name).draw(Plant.load("ves2"), np.random.default_rng([seed, 1]))
        drawn = [(then.get((e.kind, e.target), e.kind), e.target, e) for e in plant.effects]
        for kind, target, effect in sorted(drawn):
            sizes = ",".join(f"{value:.5e}" for value in effect.values.values())
            digest.update(f"{kind} {target} {sizes}".encode())
        for key in sorted({*RigSet.load(name).commissioning, *RigSet.load(name).times}):
            digest.update(
                " ".join(f"{v:.5e}" for v in plant.parameters.array(key).ravel()).encode()
            )
    assert digest.hexdigest()[:16] == RIGS[name], "a new set needs a new version"
