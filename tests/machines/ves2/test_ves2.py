"""VES II as a diagnosis sees it: when a bank may be used again."""

import numpy as np

import ves_twin as vt
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.ves2.forward import RigForward
from ves_twin.simulator.replay import replay_scenario


def identity(**changes):
    given = {name.replace("__", "."): value for name, value in changes.items()}
    scenario = vt.Scenario.load("identify_fast", given)
    return RigForward(vt.Plant.load("ves2_pressure_fast"), scenario).identity


def test_what_set_points_replace_makes_no_other_rig():
    usual = identity()
    assert identity(run__duration=5.0, run__seed=3) == usual
    assert identity(arm__moves=[]) == usual
    assert identity(platform__motion__period=12.5) == usual


def test_rigs_of_one_identity_answer_alike():
    plant = vt.Plant.load("ves2_pressure_fast")
    first = vt.Scenario.load("identify_fast", {"run.duration": 2.0})
    other = vt.Scenario.load("identify_fast", {"run.duration": 4.0, "arm.moves": []})
    made = vt.simulate(first, plant=plant, seed=1)
    rigs = [RigForward(plant, replay_scenario(made, scenario)) for scenario in (first, other)]
    assert rigs[0].identity == rigs[1].identity
    fed = Excitation.of(made, rigs[0].drive)
    assert np.array_equal(*(rig.simulate(fed, {}) for rig in rigs))


def test_a_rig_that_leaves_its_limits_has_no_channels_instead_of_ending_the_diagnosis():
    plant = vt.Plant.load("ves2_pressure_fast")
    scenario = vt.Scenario.load("identify_fast", {"run.duration": 1.0})
    made = vt.simulate(scenario, plant=plant, seed=1)
    rig = RigForward(plant, replay_scenario(made, scenario))
    fed = Excitation.of(made, rig.drive)
    assert np.all(np.isfinite(rig.simulate(fed, {})))
    failed = rig.simulate(fed, {"length_offset@leg.1:offset": 0.02})
    assert failed.shape == (len(made), len(rig.channels))
    assert np.all(np.isnan(failed))


def test_every_setting_of_the_computers_and_the_start_makes_another_rig():
    different = [
        identity(),
        identity(legs__gain=11.0),
        identity(legs__filter="feedback"),
        identity(platform__rate=79.0),
        identity(arm__start=[0.0, 0.8, 0.0]),
        identity(gravity__zero=False),
        identity(run__substeps=2),
    ]
    assert len(set(different)) == len(different)
