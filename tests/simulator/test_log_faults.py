"""Faults of the recorder: they stand in the log and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest
from once import once
from two_link import programme, rig

import ves_twin as vt
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.element import Element
from ves_twin.effects.registry import EFFECTS, build_effect
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.ves2 import forward as ves2_forward
from ves_twin.machines.ves2.forward import DRIVE, RigForward
from ves_twin.simulator.log_faults import LogFaults
from ves_twin.simulator.predict import predict

PLANT = vt.Plant.load("ves2_pressure_fast")

FAULTS = [
    build_effect(kind, row.targets[-1], {magnitude.name: magnitude.largest})
    for kind in EFFECTS
    for row in EFFECTS[kind].rows
    if EFFECTS[kind](row.targets[-1]).log
    for magnitude in EFFECTS[kind].magnitudes_of(row.targets[-1])
]


def run(*effects) -> vt.Recording:
    scenario = vt.Scenario.load("identify_fast", {"run.duration": 1.0})
    return once(vt.simulate, scenario, PLANT.extended(*effects), 3)


def test_the_four_kinds_of_the_recorder_are_tried_here():
    assert {fault.kind.removeprefix("recorder_") for fault in FAULTS} == {
        "offset",
        "gain",
        "delay",
        "cross_talk",
    }


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f"{f.kind}-{f.target}")
def test_a_fault_of_the_recorder_changes_one_signal_of_the_log_to_the_last_bit(fault):
    sound, faulty = run(), run(fault)
    changed = {name for name in sound.signals if sound[name].tobytes() != faulty[name].tobytes()}
    assert changed == {fault.log}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f"{f.kind}-{f.target}")
def test_a_log_that_is_written_in_pieces_is_the_log_written_at_once(fault):
    rng = np.random.default_rng(0)
    time = 0.0126 * np.arange(40)
    rows = np.cumsum(rng.standard_normal((40, len(PLANT.parameters.array("arm.mass")) + 3)), axis=0)
    whole = LogFaults([fault]).logged(time, {fault.log: rows, "x": rows})
    assert whole["x"] is rows
    log = LogFaults([fault])
    pieces = [
        log.logged(time[part], {fault.log: rows[part]})[fault.log]
        for part in (slice(0, 1), slice(1, 3), slice(3, 3), slice(3, 30), slice(30, 40))
    ]
    assert np.allclose(np.concatenate(pieces), whole[fault.log], rtol=0.0, atol=1e-12)
    assert not np.allclose(whole[fault.log], rows)


def test_a_diagnosis_predicts_the_log_without_a_replay_of_its_own(monkeypatch):
    asked = []

    def counted(*given):
        asked.append(given)
        return predict(*given)

    monkeypatch.setattr(ves2_forward, "predict", counted)
    recording = run()
    forward = RigForward(PLANT, vt.Scenario.load("identify_fast", {"run.duration": 1.0}))
    fed = Excitation.of(recording, DRIVE)
    sound = forward.simulate(fed, {})
    for fault in FAULTS:
        (name, size), *_ = fault.values.items()
        rows = forward.simulate(fed, {f"{fault.kind}@{fault.target}:{name}": size})
        known = replace(forward, plant=PLANT.extended(fault)).simulate(fed, {})
        assert np.array_equal(rows, known)
        for signal, columns in ves2_forward.COLUMNS.items():
            # what is fed in is the same, so the difference is the fault on noise-free rows
            changed = not np.array_equal(rows[:, columns], sound[:, columns])
            assert changed == (signal == fault.log)
    assert len(asked) == 1 + len(FAULTS)  # a rig of its own has kept no replay


def test_lengths_in_the_log_are_suspected_where_the_valves_speak_against_them():
    scenario = vt.Scenario.load("identify_fast")
    usual, misread = (
        {h.label for h in RigForward(PLANT, scenario, misread=m).hypotheses} for m in ((), (3,))
    )
    assert misread - usual == {
        "recorder_offset@leg.length.3",
        "recorder_gain@leg.length.3",
        "recorder_delay@leg.length.3",
        "recorder_cross_talk@leg.length.3.2",
    }
    assert usual - misread == {"valve_null@leg.3"}


@pytest.mark.parametrize("mode", Mode)
def test_elsewhere_a_fault_of_a_reading_is_one_of_the_log_alone(mode, tmp_path):
    """No controller of a machine of an MJCF model reads it, so it needs no kinds of its own."""
    forward, fed = MjcfForward.of(rig(tmp_path), mode), programme()
    sound = forward.simulate(fed, {})
    tried = 0
    for hypothesis in forward.hypotheses:
        on = EFFECTS[hypothesis.effect].anywhere
        if on is None or on.element is not Element.SIGNAL:
            continue
        rows = forward.simulate(fed, {hypothesis.parameters[0]: hypothesis.largest[0]})
        signal = hypothesis.target
        moved = [
            channel.signal
            for channel, one, other in zip(forward.channels, sound.T, rows.T, strict=True)
            if not np.array_equal(one, other)
        ]
        assert moved
        assert all(signal == name or signal.startswith(f"{name}.") for name in moved)
        tried += 1
    assert tried
