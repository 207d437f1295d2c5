"""settle: the rig stands under control before t = 0, everything switched on, then is zeroed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ves_twin.control.leg_loop import start_legs
from ves_twin.plant.hydraulics import loaded_pressures, resting_supply
from ves_twin.plant.physics.force_sensor import start_at
from ves_twin.plant.statics import joints_on_platform, place_rig, static_leg_forces
from ves_twin.recording.recording import Event
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.codes import RUNNING, SLOW, WANDER
from ves_twin.simulator.computers import Computers
from ves_twin.simulator.rig import Rig
from ves_twin.simulator.truth_port import GravityTruth
from ves_twin.types import FloatArray

ZEROING_SECONDS = 1.0
"""The sensor is averaged this long before the run, while the rig stands."""

STILL = 1e-4
"""Largest speed of the platform that counts as standing [m/s, rad/s]: seven times what the
transducers' noise alone makes it move."""


def settle(rig: Rig, computers: Computers, scenario: Scenario, log: FloatArray) -> int:
    """Place the rig at its start and let it stand for `run.settle` until t = 0; zero the sensor.

    Args:
        rig: the rig, whose tick ends at 0.
        computers: send the start pose at every interrupt.
        scenario: start pose, arm angles, settling time, whether to zero.
        log: a row buffer; nothing is logged before t = 0.

    Returns:
        Code of `ves_twin.simulator.codes`: RUNNING, or why the rig could not stand.
    """
    cycle_time = rig.clock.admittance * rig.clock.tick
    cycles = int(np.ceil(scenario.run.settle / cycle_time))
    averaged = min(cycles, int(ZEROING_SECONDS / cycle_time) + 1)
    pose = np.array(scenario.platform.start)
    rig.tick = -cycles * rig.clock.admittance
    _start_states(rig, pose, np.array(scenario.arm.start), computers.lengths(pose))
    computers.start_arm(rig.time)
    total = np.zeros(6)
    for cycle in range(cycles):
        computers.estimate_gravity(rig.time)
        computers.send(rig.tick, rig.time, pose)
        code, _ = rig.run(rig.clock.admittance, log, 0)
        if code != RUNNING:
            return code
        if cycle >= cycles - averaged:
            total += rig.state["sensor"]["signal"][0]
    computers.estimate_gravity(rig.time)
    if scenario.gravity.zero:
        _zero(rig, total / averaged)
    return RUNNING


def settling_events(rig: Rig, scenario: Scenario) -> Iterator[Event]:
    """What a log of the run should say about the settling."""
    speed = float(np.max(np.abs(rig.data.qvel[rig.layout.platform_dof :][:6])))
    yield Event(0.0, "settled", f"platform moves at {speed:.1e} m/s or rad/s")
    if speed > STILL:
        message = f"platform still moves at {speed:.1e} m/s or rad/s; lengthen run.settle"
        yield Event(0.0, "not_still", message)
    if scenario.gravity.zero:
        yield Event(0.0, "zeroed", "force sensor zeroed against the gravity estimate")


def _start_states(rig: Rig, pose: FloatArray, q: FloatArray, believed: FloatArray) -> None:
    """Positions, oil preload, integrators and filters of a rig that has long stood there."""
    geometry, layout, p, s = rig.plant.geometry, rig.layout, rig.parameters, rig.state
    place_rig(rig.data, layout, geometry, pose, q, joints_on_platform(rig.model))
    force = static_leg_forces(rig.model, rig.data, layout, geometry, pose)
    slide = layout.slide(rig.data)
    s["cylinder"]["column"] = slide + force / p["cylinder"]["stiffness"]
    s["supply"]["manifold"] = resting_supply(p[0]["supply"], p[0]["chambers"])
    supply = float(s["supply"]["manifold"][0])
    s["chambers"]["pressure"][0] = loaded_pressures(p[0]["chambers"], force, supply)
    s["rod_force"] = force
    s["servo"]["integral"] = rig.data.qfrc_bias[layout.arm_dof]
    rig.board["leg.length"][:] = believed
    start_legs(p[0]["legs"], s[0]["legs"], believed)
    wrench = GravityTruth(rig.model, rig.data, layout).gravity_in_sensor()
    _, slow = rig.noise.window(rig.tick - SLOW, 1)
    start_at(p[0]["sensor"], s[0]["sensor"], wrench, slow[WANDER:, 0])


def _zero(rig: Rig, signal: FloatArray) -> None:
    """Zero so that the reading equals the gravity estimate (Appendix E), or tare without one."""
    sensor = rig.state["sensor"]
    calibration = rig.parameters["sensor"]["calibration"][0]
    estimate = rig.board["gravity.estimate"]
    sensor["zero"] = signal - np.linalg.solve(calibration, estimate)
    sensor["reading"] = calibration @ (sensor["signal"][0] - sensor["zero"][0])
    rig.board["sensor.wrench"][:] = sensor["reading"][0]
