"""What a plain MJCF file has of an answer is held against held-out recordings before it is used."""

from __future__ import annotations

import numpy as np
import pytest
from two_link import programme, rig

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.machines.carried import Carried
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.rig.description import Setting
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.simulated import Simulated
from ves_twin.report.diagnosis.mjcf_lines import mjcf_lines
from ves_twin.report.diagnosis.simulated_lines import simulated_lines

RATE = 50.0


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return MjcfMachine(rig(tmp_path_factory.mktemp("two_link"), mode="motion"))


def with_present(machine, damping, **present):
    """The machine with a damping of its rail, and what else is there."""
    setting = Setting(joint="rail", attribute="damping", value=damping)
    told = machine.rig.description
    kept = [one for one in told.parameters if (one.joint, one.attribute) != ("rail", "damping")]
    told = told.model_copy(update={"present": present, "parameters": (*kept, setting)})
    return MjcfMachine(Rig(told, machine.rig.folder, machine.rig.file))


def recorded(machine):
    """What a machine shows along the programme."""
    forward, fed = machine.forward, programme()
    rows = forward.simulate(fed, {})
    signals = {name: np.array(column) for name, column in fed.drive.items()}
    for name in {channel.signal for channel in forward.channels}:
        at = [k for k, channel in enumerate(forward.channels) if channel.signal == name]
        signals[name] = rows[:, at]
    return Recording(fed.time, signals, RecordingInfo("measured"))


def test_a_file_that_has_all_of_it_is_not_spoken_of(machine):
    full = with_present(machine, 40.0)
    assert Carried.of(machine, full, [recorded(full)], RATE) is None
    assert mjcf_lines(None) == []


def test_a_drag_beside_a_friction_is_missed_and_that_is_told(machine):
    """A drag takes back most of a friction: without the drag it is worse than none."""
    fed = programme()
    fastest = np.max(np.abs(np.gradient(fed.drive["cart.position"][:, 0], fed.period)))
    full = with_present(machine, 40.0, quadratic_drag={"rail": {"drag": -40.0 / fastest}})
    found = Carried.of(machine, full, [recorded(full)], RATE)
    assert found.lacking == ("quadratic_drag on rail",)
    given, extended, part = found.errors["drive.force"]
    assert extended < 1e-6 * given < given < part
    lines = mjcf_lines(found)
    assert lines[0] == "Without quadratic_drag on rail, which is not written as MJCF."
    assert lines[-1].startswith("That is worse than no change in some: do not use it alone.")


def test_without_held_out_recordings_nothing_is_told(machine):
    full = with_present(machine, 1.0, quadratic_drag={"rail": {"drag": 3.0}})
    assert Carried.of(machine, full, [], RATE) is None


def test_what_an_answer_by_efforts_leaves_of_motion_is_told_beside_the_model_as_given(machine):
    full = with_present(machine, 40.0)
    found = Simulated.of(machine, full, [recorded(full)], RATE)
    before, after = found.errors["drive.force"]
    assert after < 1e-6 * before
    assert any(
        line.startswith("Simulated, held out: drive.force ") for line in simulated_lines(found)
    )
    assert Simulated.of(machine, full, [], RATE) is None
    assert simulated_lines(None) == []


def test_a_simulation_that_diverges_is_said_to():
    found = Simulated({"arm": (0.3, np.nan), "cart": (0.2, 0.1)}, {"arm": "rad", "cart": "m"})
    first, second = simulated_lines(found)
    assert first.startswith(
        "Simulated, held out: arm out of all bounds by the extended model, 300 m"
    )
    assert second.startswith(
        "Simulated, held out: cart 100 mm off by the extended model, 200 mm off"
    )
