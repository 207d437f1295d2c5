"""The quality gate: a healthy run passes, and every kind of damage is named."""

from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.signals import Role, Signal
from ves_twin.data.quality.check import Grade
from ves_twin.data.quality.clock_checks import check_clock
from ves_twin.data.quality.gate import quality_gate

WEIGHT = 93.7 * 9.81


@pytest.fixture(scope="module")
def healthy() -> vt.Recording:
    return vt.simulate(
        vt.Scenario.load("identify_fast", {"run.duration": 6.0, "gravity.method": "truth"})
    )


def damaged(recording, name, change) -> vt.Recording:
    values = recording[name].copy()
    change(values)
    return replace(recording, signals={**recording.signals, name: values})


def found(recording) -> dict[str, str]:
    return {c.name: c.message for c in quality_gate(recording, WEIGHT).failures}


@pytest.mark.parametrize("name", ["identify_fast", "identify_slow", "beam_horizontal_truth"])
def test_a_healthy_run_fails_no_check(name):
    run = vt.simulate(vt.Scenario.load(name, {"run.duration": 6.0}))
    report = quality_gate(run, WEIGHT)
    assert report.failures == ()
    assert any(check.grade is Grade.PASSED for check in report.checks)


def test_missing_numbers_are_named_with_their_columns(healthy):
    def lose(values):
        values[40:60, 2] = np.nan

    words = found(damaged(healthy, "sensor.wrench", lose))
    assert words["missing"].startswith("sensor.wrench.3: ")


def test_a_gap_is_found_with_its_time(healthy):
    keep = np.r_[0:100, 130 : len(healthy)]
    cut = {name: values[keep] for name, values in healthy.signals.items()}
    words = found(vt.Recording(healthy.time[keep], cut, healthy.info))
    assert "1 gaps, the longest of 0.391 s" in words["gaps"]


def test_rows_that_a_logger_held_are_repeats(healthy):
    at = np.arange(len(healthy)) // 2 * 2
    held = {name: values[at] for name, values in healthy.signals.items()}
    words = found(vt.Recording(healthy.time, held, healthy.info))["repeats"]
    count = len(healthy)
    assert words.startswith(f"{count // 2} of {count} rows repeat the one before, first at 0.013 s")
    assert "(`repeats = 2`)" in words
    once = {n: np.r_[values[:6], values[5:-1]] for n, values in healthy.signals.items()}
    assert "repeats" not in found(vt.Recording(healthy.time, once, healthy.info))  # harms nothing


@pytest.mark.parametrize(("speed", "held"), [(0.2, False), (4.0, True)])
def test_rows_of_a_slow_encoder_repeat_by_its_resolution_and_no_fault(speed, held):
    """A count now and then is a slow motion; a row that repeats at four counts a row was held."""
    counts = np.floor(speed * np.arange(400.0))
    counts[[200, 300]] = counts[[199, 299]]
    recording = vt.Recording(
        0.01 * np.arange(400), {"angle": 1e-3 * counts[:, None]}, RecordingInfo("measured")
    )
    words = {c.name: c.message for c in check_clock(recording) if c.grade is Grade.FAILED}
    assert ("repeats" in words) == held
    assert not held or words["repeats"].startswith("2 of 400 rows repeat")
    assert "come more slowly" not in words.get("repeats", "")


def test_a_coarse_encoder_that_turns_back_between_two_rows_repeats_none():
    """Four rows of a twin rotor, told in sixteenths of a degree, stood in every one of its pages."""
    angle = np.array([0.0, 3.0, 7.0, 9.0, 9.0, 6.0, 1.0, -4.0, -4.0, 0.0, 5.0, 7.0, 7.0, 3.0])
    recording = angles(np.tile(angle, 30))
    assert "repeats" not in found(recording)
    going = np.cumsum(np.tile([3.0, 8.0, 0.0, 8.0], 60))
    assert "repeats" in found(angles(going))


def test_another_rate_than_declared_is_found(healthy):
    words = found(vt.Recording(healthy.time * 1.2, healthy.signals, healthy.info))
    assert "declares 79.26 Hz" in words["rate"]


def test_a_stuck_and_a_saturated_column_are_named(healthy):
    def stick(values):
        values[:, 1] = values[0, 1]

    def saturate(values):
        values[:, 3] = np.clip(values[:, 3], *np.quantile(values[:, 3], [0.1, 0.9]))

    assert found(damaged(healthy, "leg.length", stick))["stuck"].startswith("leg.length.2 ")
    assert found(damaged(healthy, "sensor.wrench", saturate))["saturation"].startswith(
        "sensor.wrench.4 "
    )


def test_a_valve_that_is_switched_on_and_off_is_not_saturated(healthy):
    def switch(values):
        values[:, 3] = values[:, 3] > np.median(values[:, 3])

    assert "saturation" not in found(damaged(healthy, "sensor.wrench", switch))


def test_a_force_that_is_off_has_reached_no_end_of_a_range(healthy):
    """A crane's voltage that was ramped down to nothing, and stayed there."""

    def clip(values, end):
        values[:, 3] = np.maximum(values[:, 3] - np.median(values[:, 3]), 0.0) + end

    for end, told in ((0.0, False), (1.0, True)):
        flaws = found(damaged(healthy, "sensor.wrench", lambda values, end=end: clip(values, end)))
        assert ("saturation" in flaws) is told
    assert "stays at its end value as" in flaws["saturation"]


def test_swapped_legs_are_named(healthy):
    def swap(values):
        values[:, [1, 4]] = values[:, [4, 1]]

    words = found(damaged(healthy, "leg.length", swap))["wiring"]
    assert "leg.length.2 follows command 5" in words
    assert "leg.length.5 follows command 2" in words


def test_a_turned_sign_is_named(healthy):
    def turn(values):
        values[:, 0] *= -1.0

    assert found(damaged(healthy, "arm.q", turn))["sign"].startswith("arm.q.1 ")


def test_millimetres_and_degrees_are_suspected(healthy):
    def millimetres(values):
        values *= 1000.0

    def degrees(values):
        values *= 180.0 / np.pi

    assert "mm against m is" in found(damaged(healthy, "leg.length", millimetres))["units"]
    words = found(damaged(healthy, "arm.command", degrees))["units"]
    assert "degrees against radians, the other way round" in words


def test_degrees_are_suspected_where_one_joint_of_three_moves(healthy):
    """Joints that stand still, with noise on them, say nothing of the unit."""
    command, measured = healthy["arm.command"].copy(), healthy["arm.q"].copy()
    command[:, 1:] = 0.3
    measured[:, 1:] = 0.3 + 1e-5 * np.sin(np.arange(len(healthy)))[:, None]
    one = {"arm.command": command, "arm.q": np.degrees(measured)}
    words = found(replace(healthy, signals={**healthy.signals, **one}))
    assert "degrees against radians is suspected" in words["units"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda v: v.__setitem__((slice(None), [0, 2]), v[:, [2, 0]]), "axis x, expected z"),
        (lambda v: v.__imul__(-1.0), "the sign looks turned"),
        (lambda v: v.__imul__(0.4536 / 9.81 * 10), "units or payload"),
    ],
)
def test_a_foreign_frame_of_the_sensor_is_named(healthy, change, words):
    messages = " ".join(found(damaged(healthy, "sensor.wrench", change)).values())
    assert words in messages


def test_what_cannot_be_told_is_unknown_not_passed(healthy):
    still = damaged(healthy, "leg.command", lambda v: v.__setitem__(slice(None), v[0]))
    checks = quality_gate(still, WEIGHT).checks
    assert "wiring" in [c.name for c in checks if c.grade is Grade.UNKNOWN]


def test_rows_of_a_machine_that_has_not_begun_to_move_are_no_repeats(healthy):
    """The first two rows of a servo's log, before its first step, failed the gate."""
    signals = {name: values.copy() for name, values in healthy.signals.items()}
    for values in signals.values():
        values[1], values[-1] = values[0], values[-2]
    assert "repeats" not in found(vt.Recording(healthy.time, signals, healthy.info))


ANGLE = Signal("angle", ("",), ("rad",), Role.MEASUREMENT, "joint", "an angle")


def angles(values: np.ndarray, period: float = 0.01) -> vt.Recording:
    info = RecordingInfo("measured", own_signals=(ANGLE,))
    return vt.Recording(period * np.arange(len(values)), {"angle": values[:, None]}, info)


def test_a_joint_that_stops_is_no_range_that_is_too_small_and_one_that_is_cut_off_is():
    time = 0.01 * np.arange(400)
    swing = np.round(np.sin(3.0 * time) * 400.0) / 400.0
    assert "saturation" in found(angles(np.minimum(swing, 0.7)))
    settles = np.round(200.0 * (1.0 - np.exp(-4.0 * time))) / 200.0
    assert "saturation" not in found(angles(settles))


def test_a_counter_that_comes_back_every_five_rows_is_judged_without_a_traceback():
    assert "saturation" not in found(angles(np.arange(400.0) % 5))


def test_a_reading_that_drops_out_is_told_with_its_rows():
    swing = 1.0 + 0.2 * np.sin(0.01 * np.arange(400))
    swing[100:107] = 0.0
    told = found(angles(swing))["dropout"]
    assert told.startswith("angle: 1 times a jump away")
    assert "at 1.000 s, for 7 rows" in told


def test_two_runs_in_one_recording_and_a_glitch_are_told_with_their_times():
    swing = 1.0 + 0.2 * np.sin(0.03 * np.arange(400))
    swing[300:] -= 0.7
    swing[120] += 0.4
    told = found(angles(swing))
    assert "from 2.990 s to the next row" in told["jump"]
    assert "in 1 single rows, first at 1.200 s" in told["spike"]
    assert not {"jump", "spike"} & {*found(angles(0.2 * np.sin(0.03 * np.arange(400))))}


def test_a_clock_that_may_be_in_another_unit_is_doubted_and_no_flaw():
    """Slow logs of hydraulics come once a second."""
    report = quality_gate(angles(np.sin(0.3 * np.arange(400.0)), 20.0))
    doubts = [check.message for check in report.checks if check.grade is Grade.UNKNOWN]
    assert any("rows are 20 s apart" in message for message in doubts)
    assert all(check.name != "rate" for check in report.failures)
