"""What costs VES II a replay of its mechanics, and what follows from one that was made."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2 import forward as ves2_forward
from ves_twin.machines.ves2.forward import COMPARED, DRIVE, WRENCH, RigForward
from ves_twin.machines.ves2.library import with_departures
from ves_twin.simulator.predict import predict
from ves_twin.simulator.replay import replay_scenario

SENSOR = {
    "sensor_gain@sensor.fz:gain": 0.03,
    "cross_talk@sensor.mx.fy:share": 0.02,
    "sensor_mounting@sensor.rx:angle": 0.02,
    "sensor_mounting@sensor.rz:angle": -0.03,
}


@pytest.fixture(scope="module")
def made():
    plant = vt.Plant.load("ves2_pressure_fast")
    scenario = vt.Scenario.load("identify_fast", {"run.duration": 1.0})
    recording = vt.simulate(scenario, plant=plant, seed=1)
    return plant, replay_scenario(recording, scenario), recording


@pytest.fixture
def replays(monkeypatch):
    """Replays so far."""
    asked = []

    def counted(*given):
        asked.append(given[1].hash)
        return predict(*given)

    monkeypatch.setattr(ves2_forward, "predict", counted)
    return asked


def test_gain_cross_talk_and_mounting_are_laid_over_one_replay(made, replays):
    plant, scenario, recording = made
    rig = RigForward(plant, scenario)
    fed = Excitation.of(recording, rig.drive)
    nominal = rig.simulate(fed, {})
    laid = rig.simulate(fed, SENSOR)
    assert len(replays) == 1
    changed, _ = with_departures(rig._smooth, SENSOR)
    rows = Recording(fed.time - fed.time[0], fed.drive, RecordingInfo("measured"))
    answer = predict(rows, changed, scenario, DRIVE, COMPARED)
    effect = np.abs(laid - nominal)[:, WRENCH].max(axis=0)
    assert np.abs(laid[:, WRENCH] - answer["sensor.wrench"]).max() < 1e-9 * effect.max()


def test_a_rig_that_was_replayed_before_is_not_replayed_again(made, replays):
    plant, scenario, recording = made
    rig = RigForward(plant, scenario)
    fed = Excitation.of(recording, rig.drive)
    other = {"valve_null@leg.1:null": 0.002}
    first = rig.simulate(fed, {})
    rig.simulate(fed, other)
    rig.simulate(fed, {}, refined=True)
    assert len(replays) == 3
    assert np.array_equal(rig.simulate(fed, {}), first)
    rig.simulate(fed, other)
    assert len(replays) == 3
