"""settle: the rig stands under control before t = 0, everything switched on, then is zeroed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ves_twin.control.leg_loop import start_legs
from ves_twin.plant.physics.force_sensor import start_at
from ves_twin.plant.statics import place_rig, static_leg_forces
from ves_twin.simulator.build import belief_of, emulated_of
from ves_twin.simulator.clock import cycle_time
from ves_twin.simulator.codes import SLOW, WANDER
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.truth_port import GravityTruth
from ves_twin.types import FloatArray

if TYPE_CHECKING:
    from ves_twin.simulator.simulator import Simulator

ZEROING_SECONDS = 1.0
"""The sensor is averaged this long before the run, while the rig stands."""

STILL = 1e-3
"""Largest speed of the platform that counts as standing [m/s, rad/s]: ten times what the
transducers' noise alone makes it move."""


def settle(sim: Simulator) -> None:
    """Place the rig at its start, let it stand for `run.settle`, zero the sensor, set t = 0."""
    cycles = int(np.ceil(sim.scenario.run.settle / (sim.clock.admittance * sim.clock.tick)))
    sim.tick = -cycles * sim.clock.admittance
    pose = np.array(sim.scenario.platform.start)
    _start_states(sim, pose)
    computers = sim.computers
    computers.start_arm(sim.time)
    averaged = min(cycles, int(ZEROING_SECONDS / (sim.clock.admittance * sim.clock.tick)) + 1)
    total = np.zeros(6)
    for cycle in range(cycles):
        computers.estimate_gravity(sim.time)
        computers.send(sim.tick, sim.time, pose)
        sim.run_loop(sim.clock.admittance)
        if sim.outcome is not None:
            return
        if cycle >= cycles - averaged:
            total += sim.state["sensor"]["signal"][0]
    computers.estimate_gravity(sim.time)
    speed = float(np.max(np.abs(sim.data.qvel[sim.layout.platform_dof :][:6])))
    sim.note("settled", f"platform moves at {speed:.1e} m/s or rad/s")
    if speed > STILL:
        sim.note("not_still", f"platform still moves at {speed:.1e}; lengthen run.settle")
    if sim.scenario.gravity.zero:
        _zero(sim, total / averaged)
    _check_overrun(sim)


def _start_states(sim: Simulator, pose: FloatArray) -> None:
    """Positions, oil preload, integrators and filters of a rig that has long stood there."""
    geometry, layout, p, s = sim.plant.geometry, sim.layout, sim.parameters, sim.state
    believed = belief_of(sim.scenario).geometry.lengths(pose)
    place_rig(sim.data, layout, geometry, pose, np.array(sim.scenario.arm.start))
    force = static_leg_forces(sim.model, sim.data, layout, geometry, pose)
    slide = sim.data.qpos[layout.slide_qpos]
    s["cylinder"]["column"] = slide + force / p["cylinder"]["stiffness"]
    s["cylinder"]["force"] = force
    s["servo"]["integral"] = sim.data.qfrc_bias[layout.arm_dof]
    sim.board["leg.length"][:] = believed
    start_legs(p[0]["legs"], s[0]["legs"], believed)
    wrench = GravityTruth(sim.model, sim.data, layout).gravity_in_sensor()
    _, slow = sim.noise.window(sim.tick - SLOW, 1)
    start_at(p[0]["sensor"], s[0]["sensor"], wrench, slow[WANDER:, 0])


def _zero(sim: Simulator, signal: FloatArray) -> None:
    """Zero so that the reading equals the gravity estimate (Appendix E), or tare without one."""
    sensor = sim.state["sensor"]
    calibration = sim.parameters["sensor"]["calibration"][0]
    estimate = sim.board["gravity.estimate"]
    sensor["zero"] = signal - np.linalg.solve(calibration, estimate)
    sensor["reading"] = calibration @ (sensor["signal"][0] - sensor["zero"][0])
    sim.board["sensor.wrench"][:] = sensor["reading"][0]
    sim.note("zeroed", "force sensor zeroed against the gravity estimate")


def _check_overrun(sim: Simulator) -> None:
    emulated = emulated_of(sim.scenario)
    needed = cycle_time(emulated.coupling if emulated else None, sim.plant.parameters)
    period = sim.clock.admittance * sim.clock.tick
    if needed > period:
        sim.end(
            Outcome.OVERRUN,
            f"a {emulated.coupling if emulated else ''} cycle takes {needed * 1e3:.1f} ms,"
            f" the interrupt comes every {period * 1e3:.1f} ms",
        )
