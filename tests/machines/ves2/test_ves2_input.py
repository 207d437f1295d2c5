"""Recordings of VES II before a diagnosis: refused by name, or made fit."""

from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.likeness import check_likeness
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.machines.ves2.forward import DRIVE, RigForward
from ves_twin.machines.ves2.inputs import prepare_inputs
from ves_twin.simulator.replay import replay_scenario


@pytest.fixture(scope="module")
def plant():
    return vt.Plant.load("ves2_pressure_fast")


@pytest.fixture(scope="module")
def lab(plant):
    scenario = vt.Scenario.load("identify_fast", {"run.duration": 4.0, "run.settle": 0.3})
    return vt.simulate(scenario, plant=plant, seed=1)


def changed(recording, **signals):
    given = {name.replace("__", "."): values for name, values in signals.items()}
    return Recording(recording.time, {**recording.signals, **given}, recording.info)


def test_a_good_recording_passes_as_it_is(lab, plant):
    ready = prepare_inputs([lab], plant, "recording")
    assert ready.flaws == ()
    assert all(np.array_equal(ready.recordings[0][n], lab[n]) for n in lab.signals)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: {"leg__length": r["leg.length"][:, [3, 1, 2, 0, 4, 5]]}, "look swapped"),
        (lambda r: {"leg__length": 1e3 * r["leg.length"]}, "mm against m"),
        (lambda r: {"arm__q": np.degrees(r["arm.q"])}, "degrees against radians"),
        (lambda r: {"arm__q": -r["arm.q"]}, "against their command"),
    ],
)
def test_wrong_columns_are_refused_by_name_before_anything_is_simulated(lab, plant, change, words):
    with pytest.raises(VesTwinError, match=words) as caught:
        prepare_inputs([lab, changed(lab, **change(lab))], plant, "recording")
    assert str(caught.value).startswith("recording 2: ")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda r: {"leg__length": r["leg.length"][:, [1, 0, 2, 3, 4, 5]]}, "leg.length.2 should"),
        (lambda r: {"sensor__wrench": -r["sensor.wrench"]}, "the other sign"),
        (lambda r: {"sensor__wrench": r["sensor.wrench"][:, [1, 0, 2, 3, 4, 5]]}, "look swapped"),
        (lambda r: {"sensor__wrench": r["sensor.wrench"] / 4.448}, "looks like pounds"),
        (lambda r: {"arm__torque": -r["arm.torque"]}, "the other sign"),
    ],
)
def test_what_only_the_prediction_tells_is_refused_by_name(lab, plant, change, words):
    odd = changed(lab, **change(lab))
    forward = RigForward(plant, replay_scenario(lab))
    seen = preprocess(forward, [odd])
    nominal = seen.runs.one(seen.runs.origin)
    with pytest.raises(InvalidInputError, match=words):
        check_likeness(seen, nominal)
    check_likeness(preprocess(forward, [lab]), nominal)


@pytest.mark.slow
def test_large_faults_of_every_kind_are_no_mistake_of_the_wiring(lab, plant):
    """Most of the largest plausible size of each effect, on its first target."""
    forward = RigForward(plant, replay_scenario(lab))
    seen = preprocess(forward, [lab])
    runs = seen.runs
    nominal = runs.one(runs.origin)
    kinds = {h.effect: h for h in reversed(forward.hypotheses)}
    for hypothesis in kinds.values():
        shift = runs.depart(
            runs.origin, runs.indices(hypothesis), 0.7 * np.array(hypothesis.largest)
        )
        faulty = runs.one(shift)
        if np.isfinite(faulty).all():
            check_likeness(replace(seen, measured=faulty), nominal)


def test_a_flaw_that_is_no_mistake_is_told_and_carried_on_with(lab, plant):
    values = lab["leg.length"].copy()
    values[50:60] = np.nan
    ready = prepare_inputs([changed(lab, leg__length=values)], plant, "recording")
    assert [check.name for check in ready.flaws] == ["missing"]
    assert ready.flaws[0].message.startswith("recording 1: ")


def test_rows_that_are_missing_become_rows_without_measurements(lab, plant):
    kept = np.ones(len(lab), dtype=bool)
    kept[40:45] = False
    lost = Recording(lab.time[kept], {n: v[kept] for n, v in lab.signals.items()}, lab.info)
    even = prepare_inputs([lost], plant, "recording").recordings[0]
    assert len(even) == len(lab)
    assert np.isnan(even["leg.length"][40:45]).all()
    assert np.isfinite(even["leg.command"]).all()


def test_set_points_that_are_missing_are_asked_for(lab, plant):
    less = {n: v for n, v in lab.signals.items() if n != "arm.command"}
    with pytest.raises(UnknownNameError, match=r"arm\.command"):
        prepare_inputs([Recording(lab.time, less, lab.info)], plant, "recording")
    gone = lab["leg.command"].copy()
    gone[20:80] = np.nan
    with pytest.raises(InvalidInputError, match="what the rig was told"):
        prepare_inputs([changed(lab, leg__command=gone)], plant, "recording")


def test_a_recording_at_half_the_rate_is_predicted_on_its_own_rows(lab, plant):
    setting = replay_scenario(lab)
    forward = RigForward(plant, setting)
    whole = Excitation.of(lab, DRIVE)
    half = Excitation("half", whole.time[::2], {n: v[::2] for n, v in whole.drive.items()})
    every, second = forward.simulate(whole, {}), forward.simulate(half, {})
    legs = slice(0, 6)
    moved = np.ptp(every[:, legs], axis=0).max()
    # set-points drawn straight over two cycles instead of one: a small part of the motion
    gap = np.abs(second[:, legs] - every[::2, legs])[20:-20].max()
    assert gap < 0.01 * moved
    wrong = np.abs(every[: len(second), legs] - every[::2, legs][: len(second)])[20:-20].max()
    assert wrong > 0.3 * moved  # rows taken one to one would be another motion
