"""Growth rates from the linearised sampled loop are those of runs and of other linearisations."""

import dataclasses

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import VesTwinError
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.modes import structural_modes
from ves_twin.procedures.stability.growth import oscillation_growth
from ves_twin.simulator.floquet import SampledLoop, smooth_readings

STILL = {"run.noise": False, "run.duration": 6.0, "arm.moves": []}


def at_rest(scenario="beam_horizontal_truth", plant="ves2", **changes):
    world = smooth_readings(vt.Plant.load(plant))
    return vt.Simulator(world, vt.Scenario.load(scenario, STILL | changes))


def kicked(sim: vt.Simulator) -> np.ndarray:
    """Sideways motion of the platform over six seconds after a push of 0.2 N s."""
    body = sim.model.body("platform/top").id
    sim.data.xfrc_applied[body, 1] = 20.0
    sim.run_to(30)
    sim.data.xfrc_applied[body] = 0.0
    sim.advance(6.0)
    _, signals = sim.recorder.sink.collect()
    return signals["truth.pose"][:, 1]


@pytest.mark.parametrize("gain", [12.6, 15.0])
def test_growth_and_frequency_are_those_of_a_run(gain, figure):
    changes = {"legs.gain": gain}
    mode = SampledLoop(at_rest(**changes)).modes()[0]
    run = kicked(at_rest(**changes))
    late = run[80:]  # the other modes, faster by 8 /s, have died out after 1 s
    growth = oscillation_growth(late, 37 * 341e-6, (8.0, 18.0), floor=1e-9)
    # what is left of the beam's swing of 1 mm in the band moves the rate by some 0.01 /s
    less = f"of a run less the monodromy's, gain {gain}"
    figure(f"growth {less}", abs(growth.rate - mode.growth), 0.03, "1/s")
    figure(f"frequency {less}", abs(growth.frequency - mode.frequency), 0.05, "Hz")


@pytest.mark.slow
def test_what_is_under_way_in_a_delay_line_is_part_of_the_state():
    """Late valves make the loop unstable, by the growth that a run has; ranges as above."""

    def late() -> vt.Simulator:
        delay = vt.effects.ValveDelay("legs", delay=1.5e-3)
        world = smooth_readings(vt.Plant.load("ves2")).extended(delay)
        return vt.Simulator(world, vt.Scenario.load("beam_horizontal_truth", STILL))

    mode = SampledLoop(late()).modes()[0]
    growth = oscillation_growth(kicked(late())[80:], 37 * 341e-6, (8.0, 18.0), floor=1e-9)
    assert mode.growth > 0.5 > 0.0 > SampledLoop(at_rest()).modes()[0].growth
    assert abs(growth.rate - mode.growth) < 0.03  # 1/s
    assert abs(growth.frequency - mode.frequency) < 0.05  # Hz


def test_with_the_legs_at_gain_zero_the_modes_are_those_of_the_structure():
    """Another linearisation, by the engine itself, of the rig with valves closed."""
    standing = {"legs.gain": 0.0, "platform.motion.amplitude": [0.0] * 6, "arm.start": [0.0] * 3}
    found = SampledLoop(at_rest("position_sine", **standing)).modes(lowest=8.0)
    expected = structural_modes(vt.Plant.load("ves2"), np.zeros(6), np.zeros(3), highest=20.0)
    found = sorted((m for m in found if m.frequency < 20.0), key=lambda m: m.frequency)
    bending = [m for m in expected if m.bending_share > 0.9]
    assert len(bending) == 12
    for mode in bending:
        damped = mode.frequency * np.sqrt(1.0 - mode.damping**2)
        rate = -mode.damping * 2 * np.pi * mode.frequency
        # the servo's integrator and the tick's delays of its torques are in one of the two only
        near = min(abs(f.frequency - damped) / damped + abs(f.growth - rate) / 100.0 for f in found)
        assert near < 0.01


def test_mass_is_what_matters_and_the_bench_keeps_its_rest():
    sim = at_rest(**{"legs.gain": 20.9, "legs.filter": "error"})
    loop = SampledLoop(sim)
    before = loop.modes()[0]
    beam = EmulatedSystem.load("beam_horizontal_thesis")
    period = sim.rig.clock.admittance * sim.rig.clock.tick
    sim.computers.controller.emulate(beam.with_mass(200.0), period)
    heavy = loop.modes()[0]
    sim.computers.controller.emulate(beam, period)
    assert before.growth > 5.0 > 0.0 > heavy.growth
    assert loop.modes()[0] == before
    assert sim.rig.tick == 0


def test_state_that_is_no_array_is_refused():
    sim = at_rest()
    snapshot = sim.computers.snapshot()
    sim.computers.snapshot = lambda: dataclasses.replace(snapshot, controller={"a": 1})
    with pytest.raises(VesTwinError, match="state of the controller: got 'dict'"):
        SampledLoop(sim)
