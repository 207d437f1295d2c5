"""Switches: what buttons, power and pump do to the rig, between two cycles of the computers."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ves_twin.control.leg_loop import start_legs
from ves_twin.control.operation.machine import Machine
from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray
from ves_twin.plant.hydraulics import PRESSURE_FORM
from ves_twin.plant.laboratory import Laboratory
from ves_twin.simulator.rig import Rig

BRAKE_TIME, BRAKE_IMPEDANCE = 0.002, 0.99
"""Softness of a brake's dry friction [s, 1]. As stiff as the joints' own friction, the engine's
solver does not converge at this level; so a held arm creeps at 2e-4 rad/s, the legs stay closed."""


@dataclass(frozen=True)
class SwitchesSnapshot(ReadOnly):
    """Share of the pump's pressure, and torque of the joint integrators while they are off."""

    share: float
    integral: FloatArray | None


class Switches:
    """Consequences of a machine's state in the numbers of the loop and of the engine.

    Legs without power: their loop's gains are zero, so that the amplifiers give no current and
    the spools go to null. Arm without drive: the torque limit is zero. Brakes: dry friction of the
    joints. Pump: the source's pressure. While everything is on, what is written is what was there.

    Args:
        rig: the rig, settled with everything on.
        laboratory: pump and brakes.
    """

    def __init__(self, rig: Rig, laboratory: Laboratory) -> None:
        self._rig = rig
        self._laboratory = laboratory
        legs, servo, supply = (rig.parameters[name][0] for name in ("legs", "servo", "supply"))
        self._gains = float(legs["gain"]), float(legs["rate_gain"])
        self._limit = servo["limit"].copy()
        self._pressure = float(supply["pressure"])
        joints, model = rig.layout.arm_dof, rig.model
        self._friction = model.dof_frictionloss[joints].copy()
        self._softness = model.dof_solref[joints].copy(), model.dof_solimp[joints].copy()
        self._share = 1.0
        self._integral: FloatArray | None = None

    def begin(self, machine: Machine) -> None:
        """Pump and manifold of a machine that has long stood so."""
        self._share = 1.0 if machine.pump else 0.0

    def set(self, machine: Machine) -> None:
        """Write what a machine's state says."""
        rig, p = self._rig, self._rig.parameters[0]
        gain, rate_gain = self._gains if machine.legs_powered else (0.0, 0.0)
        p["legs"]["gain"], p["legs"]["rate_gain"] = gain, rate_gain
        p["servo"]["limit"] = self._limit if machine.arm_driven else 0.0
        self._brake(machine.arm_braked)
        servo = rig.state["servo"][0]
        if machine.arm_driven:
            self._integral = None
        else:  # a drive that is off does not integrate what it cannot push away
            if self._integral is None:
                self._integral = servo["integral"].copy()
            servo["integral"] = self._integral

    def pump_on(self, on: bool, seconds: float) -> None:
        """Let the manifold fill or empty for a time [s]: P' = (P0 - P) / tau, or -P / tau."""
        goal = 1.0 if on else 0.0
        if self._share == goal == 1.0:
            return
        tau = self._laboratory.run_up if on else self._laboratory.run_down
        self._share = goal + (self._share - goal) * math.exp(-seconds / tau)
        if on and self._share > 1.0 - 1e-6:
            self._share = 1.0
        self._feed()

    def close_loops(self) -> FloatArray:
        """Start the leg loops bumpless at the lengths that the legs have, and those [m] (6,)."""
        lengths = self._rig.board["leg.length"].copy()
        start_legs(self._rig.parameters[0]["legs"], self._rig.state[0]["legs"], lengths)
        return lengths

    def snapshot(self) -> SwitchesSnapshot:
        """A copy."""
        integral = None if self._integral is None else self._integral.copy()
        return SwitchesSnapshot(self._share, integral)

    def restore(self, snapshot: SwitchesSnapshot, machine: Machine) -> None:
        """Go back to a snapshot, at which the machine was as it is now."""
        self._share = snapshot.share
        self._integral = None if snapshot.integral is None else snapshot.integral.copy()
        self.set(machine)
        self._rig.parameters[0]["supply"]["pressure"] = self._pressure * self._share

    def _brake(self, on: bool) -> None:
        joints, model = self._rig.layout.arm_dof, self._rig.model
        model.dof_solref[joints], model.dof_solimp[joints] = self._softness
        model.dof_frictionloss[joints] = self._friction
        if on:
            model.dof_frictionloss[joints] += self._laboratory.brake
            model.dof_solref[joints, 0] = BRAKE_TIME
            model.dof_solimp[joints, :2] = BRAKE_IMPEDANCE

    def _feed(self) -> None:
        source = self._pressure * self._share
        self._rig.parameters[0]["supply"]["pressure"] = source
        if self._rig.parameters[0]["hydraulics"] != PRESSURE_FORM:  # no flow: the gauge follows
            self._rig.state["supply"]["manifold"] = source
