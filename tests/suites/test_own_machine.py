"""Blind suites of a machine that is not ours: what `--machine FILE` does."""

import json

import numpy as np
import pytest
import two_link

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.files import load_recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.inputs.programmes import FARTHEST, joint_of, releases
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.mjcf import BlindMjcf
from ves_twin.suites.suite import load_suite

MODES = ("control", "motion", "reference")


def blind(folder, mode="control"):
    return BlindMjcf(two_link.rig(folder, mode))


@pytest.mark.parametrize("mode", MODES)
def test_what_a_machine_measures_is_its_prediction_and_noise_as_declared(tmp_path, mode):
    machine = blind(tmp_path, mode)
    forward = machine.forward
    recording = machine.record(BlindRig(), "standstill", np.random.default_rng(0))
    for channel in forward.channels:
        rows = recording[channel.signal][:, channel.column]
        # levels of 0.9 to 1.12, colours up to 0.15, and a count of a fifth
        assert 0.85 < np.std(rows) / channel.sd < 1.2, channel.name
    moved = machine.record(BlindRig(), "train", np.random.default_rng(0))
    assert set(forward.drive) <= set(moved.signals)
    assert len(moved) == round(4.0 / moved.info.period)
    predicted = forward.simulate(Excitation.of(moved, forward.drive), {})
    for column, channel in zip(predicted.T, forward.channels, strict=True):
        left = np.std(moved[channel.signal][:, channel.column] - column)
        # half the step and another integrator are worth less than a twentieth of the motion
        assert left < max(1.3 * channel.sd, 0.05 * np.std(column)), channel.name
    assert np.max(np.std(predicted, axis=0) / [c.sd for c in forward.channels]) > 100.0


@pytest.mark.parametrize("mode", MODES)
def test_every_kind_outside_the_library_changes_what_is_measured(tmp_path, mode):
    machine = blind(tmp_path, mode)
    channels = machine.forward.channels
    plain = machine.record(BlindRig(), "train", np.random.default_rng(0))
    assert ("soft_stop" in machine.outside) == (mode != "motion")
    for kind, (_, largest) in machine.outside.items():
        rig = BlindRig({}, kind, largest)
        odd = machine.record(rig, "train", np.random.default_rng(0))
        change = [np.abs(odd[c.signal] - plain[c.signal]).max() / c.sd for c in channels]
        assert max(change) > 1.0, kind


def test_what_a_machine_is_offered_stays_within_its_travel(tmp_path):
    for rig in (two_link.rig(tmp_path), Rig.load("pendulum")):
        machine = BlindMjcf(rig)
        assert [e.name for e in MjcfMachine(rig).excitations()] == list(machine.excitations)
        column = {c.signal: i for i, c in enumerate(machine.forward.channels)}
        for programme in machine.excitations.values():
            rows = machine.forward.simulate(programme, {})
            for signal, compared in rig.description.compare.items():
                if compared.joint and compared.of == "position":
                    travel = joint_of(rig, compared.joint).travel
                    assert np.abs(rows[:, column[signal]]).max() <= FARTHEST * travel
    assert releases(two_link.rig(tmp_path)) == ()  # no start that recordings may say


def test_a_suite_of_a_machine_of_ones_own_is_moved_with_its_files(tmp_path, capsys):
    (tmp_path / "there").mkdir()
    path = two_link.write_files(tmp_path / "there")
    folder = path.parent / "suite"
    options = ["--single", "1", "--none", "1", "--outside", "0", "--pair", "0", "--seed", "1"]
    assert main(["blind", "make", "--machine", str(path), "--out", str(folder), *options]) == 0
    told = json.loads((folder / "suite.json").read_text())
    assert told["machine"] == "../two_link.toml"
    elsewhere = path.parent.rename(tmp_path / "elsewhere")
    suite = load_suite(elsewhere / "suite")
    assert Rig.load(suite.machine).description.name == "two_link"
    assert load_recording(elsewhere / "suite" / suite.cases[0] / "recording.parquet")
    capsys.readouterr()
    assert main(["blind", "make", "--machine", "no.toml", "--out", str(tmp_path / "n")]) == 2
    assert "no.toml" in capsys.readouterr().err


def test_a_machine_without_a_start_that_can_be_read_is_not_cut(tmp_path):
    with pytest.raises(InvalidInputError, match="elsewhere"):
        blind(tmp_path).record(BlindRig(), "train", np.random.default_rng(0), lead=1.0)
