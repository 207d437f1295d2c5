"""The hydraulic stage against closed forms of oil, load and flow."""

import numpy as np
import pytest

from ves_twin.effects import OilAir, ValveGain
from ves_twin.plant.hydraulics import chamber_stiffness, fill_chambers
from ves_twin.plant.physics import chambers
from ves_twin.plant.plant import Plant
from ves_twin.simulator.linear.hydraulic_stage import (
    ACCELERATION,
    LENGTH,
    SPEED,
    heave_cosines,
    hydraulic_stage,
    load_per_leg,
)

LOAD = 34.0
EXACT = 1e-9


@pytest.mark.parametrize("name", ["ves2", "ves2_pressure"])
def test_a_held_valve_ends_in_its_share_of_full_speed(name):
    plant = Plant.load(name)
    speed = hydraulic_stage(plant, LOAD)(1e-4j)[SPEED, 0]
    # the null leakage of the pressure form lets viscous friction take 0.12 %
    assert abs(speed) == pytest.approx(plant.parameters.number("hydraulics.full_speed"), rel=2e-3)


def test_the_oil_column_swings_at_the_closed_form_frequency_and_damping():
    plant = Plant.load("ves2")
    stiffness, damping = (
        plant.parameters.number(f"hydraulics.oil_{n}") for n in ("stiffness", "damping")
    )
    poles = hydraulic_stage(plant, LOAD).poles()
    swing = poles[poles.imag > 1.0][0]
    assert abs(swing) == pytest.approx(np.sqrt(stiffness / LOAD), rel=EXACT)
    assert -swing.real == pytest.approx(damping / LOAD / 2.0, rel=EXACT)


def test_without_leakage_the_chambers_swing_on_their_closed_form_stiffness():
    tight = {"chamber.conductance": 0.0, "chamber.leakage": 0.0, "chamber.viscous": 0.0}
    plant = Plant.load("ves2_pressure").with_values(tight)
    block = np.zeros(1, chambers.PARAMETERS)
    fill_chambers(block[0], plant.parameters)
    stiffness = chamber_stiffness(block[0], np.zeros(1))[0]
    poles = hydraulic_stage(plant, LOAD).poles()
    assert np.max(poles.imag) == pytest.approx(np.sqrt(stiffness / LOAD), rel=EXACT)


@pytest.mark.parametrize("name", ["ves2", "ves2_pressure"])
def test_speed_and_acceleration_are_derivatives_of_the_length(name):
    s = 2j * np.pi * 7.0
    gain = hydraulic_stage(Plant.load(name), LOAD)(s)[:, 0]
    np.testing.assert_allclose(gain[SPEED] / gain[LENGTH], s, rtol=EXACT)
    np.testing.assert_allclose(gain[ACCELERATION] / gain[LENGTH], s * s, rtol=EXACT)


def test_a_leg_feels_its_share_of_the_heaving_mass():
    """Kinetic energy of the heave equals that of six loads on their legs."""
    plant = Plant.load("ves2")
    heave = 0.3
    mass = 60.0 + 93.7 + 6 * 2.5  # platform, arm, rods of models/ves2.toml
    legs = 0.5 * load_per_leg(plant) * np.sum((heave_cosines(plant) * heave) ** 2)
    assert legs == pytest.approx(0.5 * mass * heave**2, rel=EXACT)


@pytest.mark.parametrize(
    ("name", "effect", "number", "factor"),
    [
        ("ves2", ValveGain(target="leg.1", gain=0.25), "hydraulics.valve_gain", 1.25),
        ("ves2_pressure", OilAir(target="leg.1", loss=0.5), "chamber.bulk_modulus", 0.5),
    ],
)
def test_an_effect_acts_as_the_number_that_it_changes(name, effect, number, factor):
    plant = Plant.load(name)
    value = plant.parameters.array(number)
    value[0] *= factor
    changed = plant.with_values({number: value.tolist()})
    s = 2j * np.pi * 7.0
    assert not np.allclose(hydraulic_stage(plant, LOAD)(s), hydraulic_stage(changed, LOAD)(s))
    np.testing.assert_allclose(
        hydraulic_stage(plant.extended(effect), LOAD)(s), hydraulic_stage(changed, LOAD)(s)
    )
