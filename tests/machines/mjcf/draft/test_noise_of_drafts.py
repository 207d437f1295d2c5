"""Noise that a draft reads off a log: sensors scatter, commands are rounded and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted
from scipy.signal import butter, sosfiltfilt

from ves_twin.machines.mjcf.draft.estimates import ASSUMED, noise_of
from ves_twin.machines.mjcf.draft.names import is_command

BANG = np.where(np.sin(2.0 * np.arange(800) ** 1.3) > 0.0, 4000.0, -4000.0)
"""A controller's output that jumps from row to row, in counts."""


@pytest.mark.parametrize("name", ["motor_pwm", "duty1", "tau_cmd", "u", "ctrl_2", "i_ref"])
def test_what_a_controller_put_out_is_a_command(name):
    assert is_command(name)


@pytest.mark.parametrize(
    "name", ["tau1", "motor_current", "iq", "u_meas", "pwm_torque", "force", "tau_cmd_meas"]
)
def test_what_a_sensor_reads_is_none(name):
    assert not is_command(name)


def test_a_command_has_the_noise_of_its_rounding_however_fast_it_jumps():
    values = np.round(BANG + np.arange(800) % 7)
    sd, how = noise_of(values, 0.02, None, command=True)
    assert sd == pytest.approx(1.0 / np.sqrt(12.0))
    assert how.startswith("rounding")
    assert noise_of(values, 0.02, None)[0] > 1000.0 * sd


def test_of_a_command_that_is_not_rounded_a_thousandth_is_taken():
    """The smallest step between numbers of full length is no rounding."""
    values = BANG + np.random.default_rng(1).standard_normal(800)
    sd, how = noise_of(values, 0.02, None, command=True)
    assert sd == pytest.approx(1e-3 * np.std(values))
    assert how.startswith("a thousandth")


def test_a_command_that_never_changes_tells_no_rounding():
    assert noise_of(np.ones(100), 0.02, None, command=True) == (0.0, "highest octave")


def test_a_draft_does_not_take_a_restless_command_for_a_noisy_one(swing, write):
    """The position's own noise, differentiated twice, is in both."""
    path, columns = swing
    rng = np.random.default_rng(4)
    jumps = np.round(columns["tau"] + 0.3 * rng.choice((-1.0, 1.0), 1500), 3)
    smooth = columns["q"].copy()
    smooth[5:-5] = np.convolve(columns["q"], np.ones(11) / 11.0, "valid")
    rigs = [
        drafted(path, write({"t": columns["t"], name: jumps, "q": smooth}))[1]
        for name in ("iq1", "pwm1")
    ]
    sensed, put_out = (rig.description.signals["drive.effort"].noise for rig in rigs)
    assert 0.0 < 3.0 * put_out < sensed


def low_passed(columns, corner):
    """Columns behind a filter that goes forth and back."""
    sections = butter(5, 2.0 * corner * 0.005, output="sos")
    return {n: v if n == "t" else sosfiltfilt(sections, v) for n, v in columns.items()}


def test_of_low_passed_efforts_the_noise_is_assumed_and_told(arm, columns, write):
    """What a filter took away nobody can read off: a millionth of a torque was the noise."""
    found, rig = drafted(arm, write(low_passed(columns, 2.0)))
    noise = [rig.description.signals[f"m{k}.effort"].noise for k in (1, 2, 3)]
    size = [float(np.std(low_passed(columns, 2.0)[f"tau{k}"])) for k in (1, 2, 3)]
    assert np.all(np.array(noise) >= 0.99 * ASSUMED * np.array(size))
    assert any(words.startswith("tau1, tau2, tau3: low-passed") for words in found.look)


def test_of_efforts_as_a_sensor_reads_them_it_is_read_off(arm, columns, write):
    found, _ = drafted(arm, write(columns))
    assert not any("low-passed" in words for words in found.look)


def test_one_jump_in_a_log_is_no_noise():
    """Start and stop of a measured arm at one speed made 6.2 N m of noise of 1.6."""
    rng = np.random.default_rng(3)
    torque = 18.0 + 1.5 * rng.standard_normal(234)
    jerked = torque - np.r_[np.full(29, 60.0), np.zeros(205)]
    sd, how = noise_of(jerked, 0.015, None, effort=True)
    assert how == "highest octave"
    assert 0.8 * 1.5 < sd < 1.3 * 1.5  # stretches of 58 rows tell it to a fifth


def test_of_a_joint_at_one_speed_positions_drown_no_torque(swing, write):
    """Beside its line a ramp is noise, in which a draft saw motion up to half the rate."""
    path, _ = swing
    rng = np.random.default_rng(6)
    t = 0.015 * np.arange(190)
    q, tau = t + 1e-3 * rng.standard_normal(190), 2.0 + 0.1 * rng.standard_normal(190)
    found, rig = drafted(path, write({"t": t, "q": q, "tau": tau + 0.5 * np.sin(t)}))
    assert found.mode.startswith("motion")
    told = rig.description
    assert told.drive.smoothing < 0.5 / 0.015
    assert told.signals["drive.effort"].noise < 1.0


def test_a_machine_that_mostly_dwells_has_the_noise_of_its_motion():
    rng = np.random.default_rng(1)
    t = 0.005 * np.arange(4000)
    moves = t % 10.0 < 3.0
    values = np.where(moves, 5.0 * np.sin(3.0 * t), 0.0)
    values += np.where(moves, 0.5, 1e-4) * rng.standard_normal(4000)
    sd, how = noise_of(values, 0.005, None, effort=True)
    assert how == "highest octave"
    assert 0.15 < sd < 0.55  # stretches hold motion and rest
