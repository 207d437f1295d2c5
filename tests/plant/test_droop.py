"""Droop of a frozen platform: the quasi-static creep is that of the full rig without command."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError
from ves_twin.plant.droop import creep_speed, frozen_droop
from ves_twin.plant.hydraulics import fill_chambers
from ves_twin.plant.known_weight import hang_weight
from ves_twin.plant.physics import chambers

START = [0.0, 0.0, 0.02, 0.1, -0.08, 0.1]
ARM = [0.6, 0.4, -0.3]
LIGHT_LEGS = {"leg.rod_mass": 0.25, "leg.cylinder_mass": 0.8}
"""The static leg forces leave the legs' own weight out, a tenth of it is left here."""


def test_the_full_rig_without_command_sinks_as_statics_says():
    changes = {
        "plant": "ves2_pressure", "run.duration": 3.0, "run.settle": 0.5, "run.noise": False,
        "platform.motion.amplitude": [0.0] * 6, "platform.start": START, "arm.start": ARM,
        "legs.gain": 0.0, "parameters": LIGHT_LEGS,
    }  # fmt: skip
    run = vt.simulate(vt.Scenario.load("position_sine", changes))
    first, last = run["truth.pose"][0], run["truth.pose"][-1]
    plant = vt.Plant.load("ves2_pressure").with_values(LIGHT_LEGS)
    seconds = run.time[-1] - run.time[0]
    found = frozen_droop(plant, first, np.array(ARM), np.zeros(6), seconds) - first
    # the legs' remaining weight: 6 kg beside the 154 kg of platform and arm
    np.testing.assert_allclose(found, last - first, rtol=0, atol=0.03 * np.abs(last - first).max())


def test_twice_the_time_sinks_nearly_twice_as_far():
    plant, q = vt.Plant.load("ves2"), np.array(ARM)
    once, twice = (frozen_droop(plant, np.zeros(6), q, np.zeros(6), s) for s in (1.0, 2.0))
    np.testing.assert_allclose(twice, 2.0 * once, rtol=0.05, atol=1e-5)
    assert once[2] < 0.0


def test_a_cylinder_without_any_leak_stands():
    nominal = vt.Plant.load("ves2_pressure")
    tight = {"chamber.leakage": 0.0 * nominal.parameters.array("chamber.leakage")}
    plant = nominal.with_values({**tight, "chamber.conductance": 0.0})
    block = np.zeros(1, chambers.PARAMETERS)
    fill_chambers(block[0], plant.parameters)
    with pytest.raises(InvalidInputError, match="leak"):
        creep_speed(block[0], np.zeros(6))


def test_a_hung_weight_adds_its_wrench():
    plant, q = vt.Plant.load("ves2"), np.array([ARM])
    heavier = hang_weight(plant, 5.0)
    angles = np.array([[0.05, -0.1, 0.0]])
    added = (
        heavier.gravity_model.wrench_in_top(q, angles)
        - plant.gravity_model.wrench_in_top(q, angles)
    )[0]
    weight = added[:3]
    assert np.linalg.norm(weight) == pytest.approx(5.0 * 9.81, abs=1e-9)
    np.testing.assert_allclose(added[3:], np.cross(plant.arm.tip(q[0]), weight), rtol=0, atol=1e-9)
