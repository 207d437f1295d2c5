"""settle and stand: the rig stands under control, everything switched on, then is zeroed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ves_twin.control.leg_loop import start_legs
from ves_twin.core.recording.recording import Event
from ves_twin.core.types import Block, FloatArray
from ves_twin.plant.hydraulics import loaded_pressures, resting_supply
from ves_twin.plant.physics.force_sensor import start_at
from ves_twin.plant.statics import joints_on_platform, place_rig, static_leg_forces
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.codes import RUNNING, SLOW, WANDER
from ves_twin.simulator.computers import Computers
from ves_twin.simulator.rig import Rig
from ves_twin.simulator.truth_port import GravityTruth

ZEROING_SECONDS = 1.0
"""The sensor is averaged this long before the run, while the rig stands."""

STILL = 1e-4
"""Largest speed of the platform that counts as standing [m/s, rad/s]: seven times what the
transducers' noise alone makes it move."""


@dataclass(frozen=True)
class Standing:
    """Means over the last part of a stand.

    Attributes:
        code: of `ves_twin.simulator.codes`; anything but RUNNING: it could not stand.
        signal: of the force sensor, as it comes from the electronics [N, N m] (6,).
        leg_length: measured [m] (6,).
        arm_q: measured [rad] (3,).
    """

    code: int
    signal: FloatArray
    leg_length: FloatArray
    arm_q: FloatArray


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
    stood = stand(rig, computers, pose, np.array(scenario.arm.start), (cycles, averaged), log)
    if stood.code != RUNNING:
        return stood.code
    computers.estimate_gravity(rig.time)
    if scenario.gravity.zero:
        _zero(rig, stood.signal)
    return RUNNING


def stand(
    rig: Rig,
    computers: Computers,
    pose: FloatArray,
    q: FloatArray,
    cycles: tuple[int, int],
    log: FloatArray,
) -> Standing:
    """Place the rig at a pose and let it stand there under control, from the rig's tick on.

    Args:
        rig: the rig, its tick at an interrupt.
        computers: send the pose at every interrupt; their arm motion must stay at q.
        pose: platform pose from home [m, rad] (6,).
        q: joint angles [rad] (3,).
        cycles: how many cycles, and how many of the last ones are averaged.
        log: buffer of at least one row, overwritten.
    """
    number, averaged = cycles
    _start_states(rig, pose, q, computers)
    computers.start_arm(rig.time)
    total = np.zeros(15)
    for cycle in range(number):
        computers.estimate_gravity(rig.time)
        computers.send(rig.tick, rig.time, pose)
        code, _ = rig.run(rig.clock.admittance, log, 0)
        if code != RUNNING:
            return Standing(code, *(np.full(n, np.nan) for n in (6, 6, 3)))
        if cycle >= number - averaged:
            total[:6] += rig.state["sensor"]["signal"][0]
            total[6:12] += rig.board["leg.length"]
            total[12:] += rig.board["arm.q"]
    total /= averaged
    return Standing(RUNNING, total[:6], total[6:12], total[12:])


def settling_events(rig: Rig, scenario: Scenario) -> Iterator[Event]:
    """What a log of the run should say about the settling."""
    speed = float(np.max(np.abs(rig.data.qvel[rig.layout.platform_dof :][:6])))
    yield Event(0.0, "settled", f"platform moves at {speed:.1e} m/s or rad/s")
    if speed > STILL:
        message = f"platform still moves at {speed:.1e} m/s or rad/s; lengthen run.settle"
        yield Event(0.0, "not_still", message)
    if scenario.gravity.zero:
        yield Event(0.0, "zeroed", "force sensor zeroed against the gravity estimate")


def _start_states(rig: Rig, pose: FloatArray, q: FloatArray, computers: Computers) -> None:
    """Positions, oil preload, integrators and filters of a rig that has long stood there."""
    believed = computers.lengths(pose)
    geometry, layout, p, s = rig.plant.geometry, rig.layout, rig.parameters, rig.state
    place_rig(rig.data, layout, geometry, pose, q, joints_on_platform(rig.model))
    force = static_leg_forces(rig.model, rig.data, layout, geometry, pose)
    slide = layout.slide(rig.data)
    s["cylinder"]["column"] = slide + force / p["cylinder"]["stiffness"]
    s["supply"]["manifold"] = resting_supply(p[0]["supply"], p[0]["chambers"])
    supply = float(s["supply"]["manifold"][0])
    s["chambers"]["pressure"][0] = loaded_pressures(p[0]["chambers"], force, supply)
    s["rod_force"] = force
    rig.board["leg.length"][:] = believed
    rig.board["arm.q"][:] = q
    computers.hold_arm()
    held = rig.data.qfrc_bias[layout.arm_dof] - s["servo"]["feedforward"]
    s["servo"]["integral"] = np.where(p["servo"]["integral"] > 0.0, held, 0.0)
    start_legs(p[0]["legs"], s[0]["legs"], believed)
    wrench = GravityTruth(rig.model, rig.data, layout).gravity_in_sensor()
    _, slow = rig.noise.window(rig.tick - SLOW, 1)
    _start_lines(s["late"], slide, wrench, s["current"], q)
    start_at(p[0]["sensor"], s[0]["sensor"], wrench, slow[0, WANDER:])


def _start_lines(
    late: Block, slide: FloatArray, wrench: FloatArray, current: FloatArray, q: FloatArray
) -> None:
    """Delay lines that have long seen what is there now."""
    late["slide_past"], late["wrench_past"], late["current_past"] = slide, wrench, current
    late["angle_past"][..., :3], late["rate_past"] = q, 0.0


def _zero(rig: Rig, signal: FloatArray) -> None:
    """Zero so that the reading equals the gravity estimate (Appendix E), or tare without one."""
    sensor = rig.state["sensor"]
    calibration = rig.parameters["sensor"]["calibration"][0]
    estimate = rig.board["gravity.estimate"]
    sensor["zero"] = signal - np.linalg.solve(calibration, estimate)
    sensor["reading"] = calibration @ (sensor["signal"][0] - sensor["zero"][0])
    rig.board["sensor.wrench"][:] = sensor["reading"][0]
