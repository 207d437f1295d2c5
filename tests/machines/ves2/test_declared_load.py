"""Recordings of one rig with declared loads that differ."""

from dataclasses import replace

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2.declared_load import LOAD, loads_of, with_load
from ves_twin.machines.ves2.forward import DRIVE, RigForward
from ves_twin.machines.ves2.inputs import prepare_inputs
from ves_twin.plant.known_weight import hang_weight
from ves_twin.simulator.replay import replay_scenario

PLANT = "ves2_pressure_fast"


@pytest.fixture(scope="module")
def lab():
    scenario = vt.Scenario.load("identify_fast", {"run.duration": 2.0, "run.settle": 0.3})
    return vt.simulate(scenario, plant=vt.Plant.load(PLANT), seed=1)


def answer(plant, recording, loaded):
    forward = RigForward(plant, replay_scenario(recording), loaded=loaded)
    return forward.simulate(Excitation.of(recording, forward.drive), {})


def test_a_declared_load_hangs_on_the_arm_in_its_own_recording_alone(lab):
    plant = vt.Plant.load(PLANT)
    bare = answer(plant, lab, False)
    assert np.array_equal(answer(plant, with_load(lab, 0.0), True), bare)
    heavy = answer(plant, with_load(lab, 3.0), True)
    assert np.array_equal(heavy, answer(hang_weight(plant, 3.0), lab, False))
    wrench = np.abs(heavy - bare)[:, 6:12]  # of the motion: the sensor was zeroed with the load on
    assert np.median(wrench.max(axis=1)) > 3.0


def test_a_load_is_fed_in_through_the_gate_which_expects_its_weight(lab):
    plant = vt.Plant.load(PLANT)
    (ready,) = prepare_inputs([with_load(lab, 3.0)], plant, "recording").recordings
    assert np.all(ready[LOAD.name] == 3.0)
    declared = loads_of((ready, lab))
    assert [r[LOAD.name][0, 0] for r in declared] == [3.0, 0.0]


def test_a_load_that_changes_on_the_way_is_refused(lab):
    steady = with_load(lab, 1.0)
    rows = steady[LOAD.name].copy()
    rows[5:] = 2.0
    changing = replace(steady, signals={**steady.signals, LOAD.name: rows})
    fed = Excitation.of(changing, (*DRIVE, LOAD.name), "two loads")
    forward = RigForward(vt.Plant.load(PLANT), replay_scenario(lab), loaded=True)
    with pytest.raises(InvalidInputError, match="one mass"):
        forward.simulate(fed, {})
