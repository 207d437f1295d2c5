"""The leg program's own commands: what stands in the log and not in the rig is told apart."""

from dataclasses import replace

import numpy as np
import pytest
from once import once

import ves_twin as vt
from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import Recording
from ves_twin.data.quality.check import Grade
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.registry import EFFECTS, build_effect
from ves_twin.machines.load import machine_of, named
from ves_twin.machines.machine import Material
from ves_twin.machines.ves2.inputs import prepare_inputs
from ves_twin.machines.ves2.leg_program_check import check_leg_program, misread_legs

PLANT = vt.Plant.load("ves2_pressure_fast")
BELIEVED = PLANT.parameters.number("hydraulics.full_speed")
LEGS = vt.Scenario.load("identify_slow").legs

ELSEWHERE = {"leg_bending", "filter_edge", "model_mass"}
"""Need legs with bodies, a filter, or an emulated system."""

FIRST = [
    (kind, row.targets[0])
    for kind in EFFECTS
    if kind not in ELSEWHERE
    for row in EFFECTS[kind].rows
    if not EFFECTS[kind](row.targets[0]).log
]


def run(*effects, **legs):
    changes = {"run.duration": 5.0, **{f"legs.{k}": v for k, v in legs.items()}}
    scenario = vt.Scenario.load("identify_slow", changes)
    return once(vt.simulate, scenario, PLANT.extended(*effects), 3)


def logged(recording, *columns, by=0.0):
    """The same run, some lengths off in the log alone."""
    lengths = recording["leg.length"] + by * np.isin(range(6), columns)
    return replace(recording, signals={**recording.signals, "leg.length": lengths})


def check(recording, legs=LEGS):
    return check_leg_program(recording, legs, BELIEVED)


@pytest.mark.parametrize("place", ["none", "error", "feedback"])
def test_a_log_as_the_program_read_it_passes(place):
    recording = run(filter=place)
    assert check(recording).grade is Grade.PASSED
    wrong = check(logged(recording, 1, 4, by=-1e-3))
    assert wrong.grade is Grade.FAILED
    assert misread_legs([wrong, check(recording)]) == (2, 5)
    assert wrong.message.startswith("leg.length.2 by -1.00 mm, leg.length.5 by -1.00 mm is off")


def test_an_offset_in_the_log_alone_is_refused_and_named_in_place_of_a_valve_null():
    """It was once named `valve_null`, firmly."""
    recording = run()
    prepare_inputs([recording], PLANT, "recording")
    both = [recording, logged(recording, 2, by=2.5e-3)]
    with pytest.raises(VesTwinError, match=r"recording 2: leg.length.3 by \+2.50 mm"):
        prepare_inputs(both, PLANT, "recording")
    (flaw,) = prepare_inputs(both, PLANT, "recording", misread=True).flaws
    assert flaw.message.startswith("recording 2: leg.length.3 by +2.50 mm")


@pytest.mark.parametrize(
    ("kind", "target", "sizes", "legs"),
    [
        ("recorder_gain", "leg.length.4", {"gain": 2e-3}, (4,)),
        ("recorder_delay", "leg.length.5", {"delay": 0.012}, (5,)),
        ("recorder_cross_talk", "leg.length.2.1", {"share": 1e-3}, (2,)),
        ("recorder_delay", "arm.q", {"delay": 0.02}, ()),
    ],
)
def test_other_faults_of_the_log_are_told_by_leg_too(kind, target, sizes, legs):
    assert misread_legs([check(run(build_effect(kind, target, sizes)))]) == legs


def test_a_machine_suspects_the_log_of_what_is_diagnosed_and_refuses_it_of_a_baseline():
    sound = run()
    off = logged(sound, 2, by=2.5e-3)
    machine = machine_of(PLANT)
    given = Material(named([off], "recording"))
    assert machine.prepare(given).machine.misread == (3,)
    with pytest.raises(VesTwinError, match=r"baseline recording 1: leg.length.3"):
        machine.prepare(replace(given, baseline=named([off], "baseline recording")))


def test_an_offset_of_a_fiftieth_of_a_millimetre_is_borne_and_a_third_is_not():
    for by, grade in ((2e-5, Grade.PASSED), (3e-4, Grade.FAILED)):
        assert check(logged(run(), 3, by=by)).grade is grade


@pytest.mark.parametrize(
    "effect",
    [
        build_effect("valve_null", "leg.3", {"null": 0.02}),
        build_effect("transducer_delay", "leg.2", {"delay": 0.01}),
        build_effect("valve_gain", "leg.4", {"gain": -0.3}),
        build_effect("command_limit", "legs", {"tightness": 9.0}),
    ],
    ids=lambda effect: effect.kind,
)
def test_what_is_wrong_with_the_rig_itself_is_left_to_the_diagnosis(effect):
    assert check(run(effect)).grade is Grade.PASSED


@pytest.mark.nightly
@pytest.mark.parametrize(("kind", "target"), FIRST)
def test_no_registered_effect_is_taken_for_a_fault_of_the_log(kind, target):
    for magnitude in EFFECTS[kind].magnitudes_of(target):
        size = min(10.0 * magnitude.smallest, magnitude.largest)
        size *= -1.0 if magnitude.sign is Sign.NEGATIVE else 1.0
        effect = build_effect(kind, target, {magnitude.name: size})
        assert check(run(effect)).grade is not Grade.FAILED


@pytest.mark.parametrize("lost", ["leg.command", "leg.length", "valve.command"])
def test_without_a_signal_it_cannot_tell(lost):
    recording = run()
    signals = {name: rows for name, rows in recording.signals.items() if name != lost}
    assert check(Recording(recording.time, signals, recording.info)).grade is Grade.UNKNOWN


def test_rows_that_are_cut_off_or_empty_count_for_nothing():
    recording = run()
    lengths, valves = recording["leg.length"].copy(), recording["valve.command"].copy()
    lengths[100:140, 2] = np.nan
    valves[200:220, 1] = 0.9
    signals = {**recording.signals, "leg.length": lengths, "valve.command": valves}
    assert check(replace(recording, signals=signals)).grade is Grade.PASSED
    few = Recording(recording.time[:30], {n: r[:30] for n, r in signals.items()}, recording.info)
    assert check(few).grade is Grade.UNKNOWN
