"""The admittance computer's program with other numbers, while the loop is closed."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.simulator.replay import replay

FLOATING = {"run.duration": 0.6, "run.settle": 0.3}


def run(*effects, **changes) -> vt.Recording:
    scenario = vt.Scenario.load("beam_horizontal_truth", FLOATING | changes)
    return vt.simulate(scenario, vt.Plant.load("ves2").extended(*effects))


def test_an_older_estimate_is_the_scenario_s_age_to_the_last_bit():
    age = vt.Scenario.load("beam_horizontal_truth").gravity.age
    stale = run(vt.effects.StaleGravity("computers", cycles=3.0))
    meant = run(**{"gravity.age": age + 3})
    np.testing.assert_array_equal(stale["platform.command"], meant["platform.command"])
    assert not np.array_equal(stale["platform.command"], run()["platform.command"])


def test_a_model_of_another_mass_moves_the_base_and_leaves_the_zero_g_reference():
    heavy = run(vt.effects.ModelMass("computers", share=0.2))
    assert np.abs(heavy["platform.command"] - run()["platform.command"]).max() > 1e-6
    references = [name for name in heavy.signals if name.startswith("reference")]
    assert references
    for name in references:
        np.testing.assert_array_equal(heavy[name], run()[name])


def test_the_deployed_mass_is_the_named_system_s_times_its_share():
    scenario = vt.Scenario.load("beam_horizontal_truth", FLOATING)
    numbers = {"emulated.mass": EmulatedSystem.load(scenario.platform.emulated).mass.copy()}
    expected = 1.2 * numbers["emulated.mass"]
    vt.effects.ModelMass("computers", share=0.2).edit_computers(numbers)
    np.testing.assert_array_equal(numbers["emulated.mass"], expected)


def test_without_an_emulated_system_a_model_mass_is_refused():
    plant = vt.Plant.load("ves2").extended(vt.effects.ModelMass("computers", share=0.1))
    with pytest.raises(InvalidInputError, match=r"model_mass.*an emulated system"):
        vt.Simulator(plant, vt.Scenario.load("position_sine", {"run.settle": 0.02}))


def test_a_replay_cannot_see_the_computers():
    """Set-points and estimate are played back, so that the answer is the same to the last bit."""
    recording = run()
    effects = (
        vt.effects.ModelMass("computers", share=0.3),
        vt.effects.StaleGravity("computers", cycles=4.0),
    )
    plain, changed = (
        replay(recording, vt.Plant.load("ves2").extended(*found)) for found in ((), effects)
    )
    for signal in ("leg.length", "sensor.wrench", "arm.q"):
        np.testing.assert_array_equal(plain[signal], changed[signal])
