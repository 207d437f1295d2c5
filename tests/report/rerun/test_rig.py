"""The rig that is drawn is the rig of the recording, also when a plant file made it."""

import ves_twin as vt
from ves_twin.report.rerun.rig import DrawnRig


def test_drawn_rig_is_the_plant_of_the_run():
    plant = vt.Plant.load("ves2").with_values({"platform.base_radius": 0.8, "leg.rod_mass": 3.0})
    changes = {"run.duration": 0.1, "run.settle": 0.1, "parameters": {"platform.mass": 70.0}}
    run = vt.simulate(vt.Scenario.load("position_sine", changes), plant=plant)
    assert set(run.info.parameters) == {"platform.base_radius", "leg.rod_mass", "platform.mass"}
    drawn = DrawnRig.of(run.info)
    assert drawn.note == ""
    assert abs(abs(drawn.geometry.base[0, :2] @ drawn.geometry.base[0, :2]) - 0.64) < 1e-12


def test_run_with_pressure_hydraulics_names_its_base():
    changes = {"run.duration": 0.1, "run.settle": 0.1, "plant": "ves2_pressure"}
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    assert run.info.plant_base == "ves2_pressure"
    assert run.info.parameters == {}
    assert DrawnRig.of(run.info).note == ""
