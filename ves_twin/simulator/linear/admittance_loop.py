"""admittance_loop: one axis of the emulation with its payload, at the ticks of the rig."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.control.leg_loop import FilterPlace, chebyshev_section
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.simulator.linear.hydraulic_stage import (
    ACCELERATION,
    LENGTH,
    SPEED,
    heave_cosines,
    hydraulic_stage,
    load_per_leg,
)
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.simulator.linear.periodic import PeriodicSystem

if TYPE_CHECKING:
    from control import StateSpace

TRIAL_FREQUENCY, TRIAL_DAMPING = 0.3, 0.05
"""Bare frequency [Hz] and damping ratio of the model whose mass is varied; assumed, since 5.4 does
not give them."""


@dataclass(frozen=True)
class AxisModel:
    """Emulated base of one axis, m y'' + b y' + k y = w [kg, N s/m, N/m]."""

    mass: float
    damping: float
    stiffness: float

    @staticmethod
    def trial(mass: float) -> AxisModel:
        """The model of TRIAL_FREQUENCY and TRIAL_DAMPING with a mass [kg]."""
        omega = 2.0 * np.pi * TRIAL_FREQUENCY
        return AxisModel(mass, 2.0 * TRIAL_DAMPING * omega * mass, omega**2 * mass)


def payload_mass(plant: Plant) -> float:
    """Mass on the force sensor: the arm [kg]."""
    return float(np.sum(plant.actual.array("arm.mass")))


def admittance_loop(
    plant: Plant, settings: LegSettings, model: AxisModel, rate: float
) -> PeriodicSystem:
    """Heave of the platform under admittance control, the payload rigid on the sensor.

    In the order of a tick of the rig: the computer steps the exact zero-order hold of the model
    with the reading of one tick before and sends its new position; the leg controller reads the
    length and sets its valve command; the amplifier takes it; oil and rod move; the sensor
    filters -m a, the payload's inertia, at the corner of its second-order Butterworth. The input
    is an outer force on the payload, the output the length of a leg times its cosine: the heave.

    Args:
        plant: numbers.
        settings: the leg loops.
        model: the emulated base.
        rate: admittance cycles [Hz]; the nearest whole number of ticks is taken.

    Source: thesis fig. 5-6, 5.4.
    """
    table = plant.actual
    tick = table.number("clock.tick")
    leg, amplifier = (round(table.number(f"clock.{n}_ticks")) for n in ("leg", "amplifier"))
    cycle = round(1.0 / (rate * tick))
    if cycle < 1:
        raise InvalidInputError("rate", rate, f"at most {1.0 / tick:.0f} Hz, one tick")
    states = _States(plant, settings, model, cycle * tick)
    count = math.lcm(cycle, leg, amplifier)
    maps, inputs = np.empty((count, states.size, states.size)), np.zeros((count, states.size))
    for k in range(count):
        step = np.eye(states.size)
        if k % cycle == 0:
            step = states.computer @ step
        if k % leg == 0:
            step = states.controller @ step
        if k % amplifier == 0:
            step = states.amplifier @ step
        maps[k] = states.rig @ step
        inputs[k] = states.kick
    return PeriodicSystem(maps, inputs, states.heave, states.speed, tick)


class _States:
    """The states of the axis and one matrix for each thing that happens to them.

    Order: hydraulic stage, amplifier, valve command, section (2), previous length, commanded
    length, sensor filter (2), reading, model position and velocity. Lengths are of a leg.
    """

    def __init__(self, plant: Plant, settings: LegSettings, model: AxisModel, cycle: float) -> None:
        stage = hydraulic_stage(plant, load_per_leg(plant))
        n = len(stage.A)
        names = ("current", "valve", "z1", "z2", "previous", "command", "f1", "f2", "reading")
        self.at = {name: n + i for i, name in enumerate((*names, "y", "y_rate"))}
        self.size = n + len(self.at)
        self.cosine = float(np.sqrt(np.mean(heave_cosines(plant) ** 2)))
        self.length = np.zeros(self.size)
        self.length[:n] = stage.C[LENGTH]
        self.heave = self.length / self.cosine
        self.speed = np.zeros(self.size)
        self.speed[:n] = stage.C[SPEED]
        self.computer = self._computer(model, cycle)
        self.controller = self._controller(plant, settings)
        self.amplifier = self._copy("current", "valve")
        self.rig, self.kick = self._rig(plant, stage)

    def _computer(self, model: AxisModel, cycle: float) -> FloatArray:
        from scipy.linalg import expm  # slow to import

        block = np.zeros((3, 3))
        block[0, 1] = 1.0
        block[1] = np.array([-model.stiffness, -model.damping, 1.0]) / model.mass
        hold = expm(block * cycle)
        m, at = np.eye(self.size), self.at
        for i, row in enumerate(("y", "y_rate")):
            m[at[row]] = 0.0
            m[at[row], [at["y"], at["y_rate"], at["reading"]]] = hold[i]
        m[at["command"]] = self.cosine * m[at["y"]]
        return m

    def _controller(self, plant: Plant, settings: LegSettings) -> FloatArray:
        table, at = plant.actual, self.at
        period = table.number("clock.leg_ticks") * table.number("clock.tick")
        b, a = chebyshev_section(1.0 / period)
        unit = np.eye(self.size)
        error = unit[at["command"]] - self.length
        m = np.eye(self.size)
        if settings.place is FilterPlace.NONE:
            m[[at["z1"], at["z2"]]] = 0.0
        else:
            x = self.length if settings.place is FilterPlace.FEEDBACK else error
            y = b[0] * x + unit[at["z1"]]
            m[at["z1"]] = b[1] * x - a[1] * y + unit[at["z2"]]
            m[at["z2"]] = b[2] * x - a[2] * y
            error = unit[at["command"]] - y if settings.place is FilterPlace.FEEDBACK else y
        speed = (self.length - unit[at["previous"]]) / period
        m[at["previous"]] = self.length
        asked = settings.gain * error - settings.rate_gain * speed
        m[at["valve"]] = asked / table.number("hydraulics.full_speed")
        return m

    def _copy(self, to: str, of: str) -> FloatArray:
        m = np.eye(self.size)
        m[self.at[to]] = np.eye(self.size)[self.at[of]]
        return m

    def _rig(self, plant: Plant, stage: StateSpace) -> tuple[FloatArray, FloatArray]:
        """One tick of oil, rod and sensor; and what 1 N on the payload does to it."""
        from scipy.linalg import expm
        from scipy.signal import butter

        table, at = plant.actual, self.at
        tick = table.number("clock.tick")
        a, b = np.asarray(stage.A), np.asarray(stage.B)
        n = len(a)
        block = np.zeros((n + 1, n + 1))
        block[:n, :n], block[:n, n:] = a, b
        moved = expm(block * tick)
        m, kick = np.eye(self.size), np.zeros(self.size)
        m[:n, :n], m[:n, at["current"]] = moved[:n, :n], moved[:n, n]
        force = np.zeros(self.size)
        force[:n] = np.asarray(stage.C)[ACCELERATION]
        force *= -payload_mass(plant) / self.cosine
        unit = np.eye(self.size)
        b2, a2 = butter(2, table.number("sensor.corner"), fs=1.0 / tick)
        y = b2[0] * force + unit[at["f1"]]
        m[at["f1"]] = b2[1] * force - a2[1] * y + unit[at["f2"]]
        m[at["f2"]] = b2[2] * force - a2[2] * y
        m[at["reading"]] = y
        kick[at["reading"]] = b2[0]
        kick[at["f1"]] = b2[1] - a2[1] * b2[0]
        kick[at["f2"]] = b2[2] - a2[2] * b2[0]
        return m, kick
