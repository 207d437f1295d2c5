"""The tracking error is truth less command, of runs that emulate nothing and have no operator."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.simulator.tracking_error import tells_tracking, tracking_error


@pytest.fixture
def rows():
    rng = np.random.default_rng(5)
    return tuple(rng.normal(size=(100, 6)) for _ in range(2))


def test_error_is_truth_less_command_and_its_share_is_of_the_motion_from_home(rows):
    truth, command = rows
    home = np.full(6, 0.2)
    found = tracking_error([rows], home)["ry"]
    error = truth[:, 4] - command[:, 4]
    assert found.rms == pytest.approx(np.sqrt(np.mean(error**2)))
    assert found.peak == pytest.approx(np.max(np.abs(error)))
    size = np.max(np.linalg.norm((command - home)[:, 3:], axis=1))
    assert found.relative == pytest.approx(found.peak / size)


def test_parts_give_the_same_as_the_whole(rows):
    parts = [tuple(values[k : k + 30] for values in rows) for k in range(0, 100, 30)]
    whole, pieces = tracking_error([rows]), tracking_error(parts)
    for axis, error in whole.items():
        assert pieces[axis].rms == pytest.approx(error.rms, rel=1e-14)
        assert (pieces[axis].peak, pieces[axis].relative) == (error.peak, error.relative)


def test_a_command_that_stands_has_no_relative_error_and_nothing_has_no_figure(rows):
    assert tracking_error([(rows[0], np.zeros((100, 6)))])["z"].relative is None
    assert tracking_error([]) == {}
    assert tracking_error([(rows[0] * np.nan, rows[1])]) == {}


@pytest.mark.parametrize(
    ("scenario", "tells"),
    [
        ("position_sine", True),
        ("beam_horizontal_truth", False),  # an emulated base is held against zero gravity
        ("operation_session", False),  # legs without current follow nothing
    ],
)
def test_it_is_told_where_the_platform_is_to_follow(scenario, tells):
    assert tells_tracking(vt.Scenario.load(scenario)) is tells


def test_a_run_that_emulates_nothing_tells_how_the_platform_follows(tmp_path):
    """Legs of gain K follow a slow motion v late by 1/K: error v / K."""
    changes = {"run.duration": 2.0, "run.settle": 0.5, "run.noise": False}
    scenario = vt.Scenario.load("position_sine", changes)
    summary = vt.record(scenario, tmp_path, plant=vt.Plant.load("ves2_fast"))
    assert summary.emulation_error == {}
    run = vt.load_recording(tmp_path)
    error = run["truth.pose"][:, 0] - run["platform.command"][:, 0]
    assert summary.tracking_error["x"].rms == pytest.approx(np.sqrt(np.mean(error**2)))
    speed = np.gradient(run["platform.command"][:, 0], run.time)
    late = np.sqrt(np.mean(speed**2)) / scenario.legs.gain
    assert summary.tracking_error["x"].rms == pytest.approx(late, rel=0.25)
