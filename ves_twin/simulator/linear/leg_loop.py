"""leg_loop: one leg's closed loop as the leg controller samples it, with python-control."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ves_twin.control.leg_loop import FilterPlace, chebyshev_section
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.plant.parameters import ParameterTable
from ves_twin.plant.plant import Plant
from ves_twin.simulator.linear.hydraulic_stage import LENGTH, hydraulic_stage, load_per_leg
from ves_twin.simulator.linear.leg_settings import LegSettings

if TYPE_CHECKING:
    from control import StateSpace, TransferFunction


def leg_period(parameters: ParameterTable) -> float:
    """Time between two samples of the leg loop [s]."""
    return parameters.number("clock.leg_ticks") * parameters.number("clock.tick")


def section(parameters: ParameterTable) -> TransferFunction:
    """The second-order Chebyshev section at the rate of the leg loop (thesis Table 5-1)."""
    from control import TransferFunction  # slow to import

    period = leg_period(parameters)
    numerator, denominator = chebyshev_section(1.0 / period)
    return TransferFunction(numerator, denominator, period)


def leg_actuator(plant: Plant) -> StateSpace:
    """From the speed that the leg controller asks for [m/s] to the length that it measures [m].

    A command waits for the next tick of the amplifiers, 0, 1 or 2 ticks in turn, and is held. The
    mean over that pattern makes the actuator time-invariant:

        x(k+1) = Phi x(k) + G1 u(k-1) + G0 u(k).

    Args:
        plant: numbers of valve, oil and clocks; a leg moves its share of a heaving platform.

    Raises:
        InvalidInputError: amplifiers slower than the leg loop.

    Returns:
        A system sampled with the leg loop.
    """
    from control import StateSpace

    table = plant.actual
    tick = table.number("clock.tick")
    leg, amplifier = (round(table.number(f"clock.{n}_ticks")) for n in ("leg", "amplifier"))
    if amplifier > leg:
        raise InvalidInputError("clock.amplifier_ticks", amplifier, f"at most {leg}, a leg cycle")
    stage = hydraulic_stage(plant, load_per_leg(plant))
    waits = [-k % amplifier for k in range(0, math.lcm(leg, amplifier), leg)]
    size = len(stage.A)
    a, b = np.zeros((size + 1, size + 1)), np.zeros((size + 1, 1))
    for wait in waits:
        phi_old, gamma_old = _held(stage, wait * tick)
        phi_new, gamma_new = _held(stage, (leg - wait) * tick)
        a[:size, :size] += phi_new @ phi_old / len(waits)
        a[:size, size:] += phi_new @ gamma_old / len(waits)
        b[:size] += gamma_new / len(waits)
    b[size] = 1.0
    c = np.append(stage.C[LENGTH], 0.0)[None]
    return StateSpace(a, b / table.number("hydraulics.full_speed"), c, [[0.0]], leg * tick)


def leg_loop(plant: Plant, settings: LegSettings) -> StateSpace:
    """From commanded to measured length, closed loop.

    u = gain e - rate_gain dL/dt, with the section on the error, on the measured length, or
    nowhere. The rate is the difference of two measured lengths over a leg cycle.

    Source: thesis figs 5-4, 5-7, 5-9.
    """
    from control import StateSpace, feedback

    inner = _with_rate(plant, settings)
    filtering = StateSpace(*_section_matrices(plant.actual))
    if settings.place is FilterPlace.ERROR:
        closed = feedback(inner * filtering * settings.gain, 1)
    elif settings.place is FilterPlace.FEEDBACK:
        closed = feedback(inner * settings.gain, filtering)
    else:
        closed = feedback(inner * settings.gain, 1)
    return closed


def _with_rate(plant: Plant, settings: LegSettings) -> StateSpace:
    from control import StateSpace, feedback

    actuator = leg_actuator(plant)
    period = leg_period(plant.actual)
    gain = settings.rate_gain / period
    rate = StateSpace([[0.0]], [[1.0]], [[-gain]], [[gain]], period)
    return feedback(actuator, rate)


def _section_matrices(
    parameters: ParameterTable,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, float]:
    """The section in observable form, as the leg controller computes it."""
    period = leg_period(parameters)
    b, a = chebyshev_section(1.0 / period)
    matrix = np.array([[-a[1], 1.0], [-a[2], 0.0]])
    column = np.array([[b[1] - a[1] * b[0]], [b[2] - a[2] * b[0]]])
    return matrix, column, np.array([[1.0, 0.0]]), np.array([[b[0]]]), period


def _held(stage: StateSpace, seconds: float) -> tuple[FloatArray, FloatArray]:
    """Transition of the stage over a time with its input held."""
    from scipy.linalg import expm  # slow to import

    size = len(stage.A)
    block = np.zeros((size + 1, size + 1))
    block[:size, :size], block[:size, size:] = stage.A, stage.B
    exponential = expm(block * seconds)
    return exponential[:size, :size], exponential[:size, size:]
