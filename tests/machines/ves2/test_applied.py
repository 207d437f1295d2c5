"""applied: what a diagnosis gets of recordings that an experiment file speaks of."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.files import save_recording
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.machines.machine import Material, Named
from ves_twin.machines.ves2.applied import applied
from ves_twin.machines.ves2.ves2_machine import Ves2Machine
from ves_twin.mechanics.kinematics.stewart import leg_lengths
from ves_twin.scenario.experiment import Experiment

T = np.arange(400) * 0.0126
HOME = {"scenario": "identify_fast", "plant": "ves2_fast"}


def recording(*names, value=1.0):
    signals = {n: np.full((400, 3 if n.startswith("arm") else 6), value) for n in names}
    return vt.Recording(T, signals, RecordingInfo("measured"))


LEGS = recording("leg.command", "leg.length", "sensor.wrench")


def named(**recordings):
    return tuple(Named(name, one) for name, one in recordings.items())


def tell(experiment, plant=None, **recordings):
    """The recordings alone."""
    return applied(named(**recordings), experiment, plant)[0]


def test_set_points_that_were_not_recorded_are_filled_in():
    given = {"state": "given", "pose": [0.0] * 6, "joints": [0.1, 0.2, 0.3]}
    (found,), plant, scenario = applied(named(a=LEGS), Experiment(**HOME, start=given), None)
    assert np.array_equal(found["arm.command"][7], [0.1, 0.2, 0.3])
    assert not found["gravity.estimate"].any()
    assert scenario.name == "identify_fast"
    assert plant.name == "ves2_fast"


def test_poses_become_lengths_by_the_inverse_kinematics_of_the_rig():
    pose = np.tile([0.01, 0.0, 0.02, 0.0, 0.05, 0.0], (400, 1))
    raw = vt.Recording(T, {"platform.command": pose}, RecordingInfo("measured"))
    (found,) = tell(Experiment(**HOME), a=raw)
    g = vt.Plant.load("ves2").geometry
    assert np.allclose(found["leg.command"][3], leg_lengths(pose[3], g.base, g.top, g.home))


def test_only_what_is_to_be_compared_is_compared():
    (found,) = tell(Experiment(**HOME, compare=["leg.length"]), a=LEGS)
    assert "sensor.wrench" not in found.signals
    (found,) = tell(Experiment(**HOME), a=LEGS)
    assert "sensor.wrench" in found.signals


@pytest.mark.parametrize(
    ("words", "first"),
    [
        ({"window": {"start": 1.0, "stop": 4.0}}, 1.0),
        ({"start": {"state": "estimated", "forget": 2.0}, "window": {"stop": 4.0}}, 2.0),
    ],
)
def test_what_is_not_compared_keeps_its_set_points(words, first):
    (found,) = tell(Experiment(**HOME, **words), a=LEGS)
    assert found.time[-1] < 4.0
    assert np.isfinite(found["leg.command"]).all()
    seen = np.isfinite(found["leg.length"]).all(axis=1)
    assert np.array_equal(seen, found.time >= first)


def test_payload_and_parameters_make_the_rig():
    told = Experiment(**HOME, payload="2 kg", parameters={"sensor.corner": 19.0})
    _, plant, _ = applied(named(a=LEGS), told, vt.Plant.load("ves2"))
    assert plant.name == "ves2"
    assert plant.parameters.number("sensor.corner") == 19.0
    assert plant.parameters.array("arm.mass")[3] == pytest.approx(
        vt.Plant.load("ves2").parameters.array("arm.mass")[3] + 2.0
    )


def test_the_recording_that_tells_the_noise_is_loaded_unless_another_is_given(tmp_path):
    save_recording(LEGS, tmp_path / "still.parquet")
    told = Experiment(**HOME, noise=str(tmp_path / "still.parquet"))
    machine = Ves2Machine(vt.Plant.load("ves2_fast"))
    found = machine.prepare(Material(named(a=LEGS)), told).material
    assert len(found.standstill) == 400
    other = recording("leg.length")
    found = machine.prepare(Material(named(a=LEGS), standstill=other), told).material
    assert found.standstill is other


def test_one_recording_may_have_a_window_of_its_own_and_no_rig_of_its_own():
    own = Experiment(**HOME, recordings={"b": {"window": {"stop": 2.0}}})
    a, b = tell(own, **{"a": LEGS, "b.parquet": LEGS})
    assert a.time[-1] == T[-1]
    assert b.time[-1] < 2.0
    for words, says in (
        ({"b": {"parameters": {"sensor.corner": 19.0}}}, "one rig in all recordings"),
        ({"b": {"noise": "still.parquet"}}, "one noise source"),
        ({"bb": {"payload": 1.0}}, "did you mean 'b'"),
        ({"b": {"window": {"start": 90.0}}}, "window of b"),
    ):
        with pytest.raises(VesTwinError, match=says):
            Ves2Machine().prepare(
                Material(named(a=LEGS, b=LEGS)), Experiment(**HOME, recordings=words)
            )


def test_each_recording_may_carry_a_declared_load_of_its_own():
    own = Experiment(**HOME, payload="1 kg", recordings={"b": {"payload": "3 kg"}})
    both, plant, _ = applied(named(a=LEGS, b=LEGS), own, None)
    assert [r["load.mass"][0, 0] for r in both] == [1.0, 3.0]
    assert plant.hash == applied(named(a=LEGS), Experiment(**HOME), None)[1].hash
    alike = tell(Experiment(**HOME, payload="1 kg"), a=LEGS, b=LEGS)
    assert not any("load.mass" in r.signals for r in alike)
