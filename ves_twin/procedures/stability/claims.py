"""measure_claims: what the thesis's chapter 5 claims, measured on a plant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.control.leg_loop import EDGE, FilterPlace
from ves_twin.plant.modes import structural_modes
from ves_twin.plant.plant import Plant
from ves_twin.procedures.stability.one_axis import OneAxis
from ves_twin.procedures.stability.stability_bench import StabilityBench
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.floquet import smooth_readings
from ves_twin.simulator.linear.leg_settings import RATE_GAIN_PER_K2
from ves_twin.simulator.simulate import simulate

HEAVES = (-0.15, 0.0, 0.15)
"""Platform heights over which the first mode is looked at [m] (thesis 5.2)."""

SERVO = 0.4
"""Damping ratio between structural modes, below 0.2, and those of the joint servos, above 0.6."""

NO_MODE = 40.0
"""Frequency that stands for legs without a lightly damped mode below it [Hz]."""

PRINTED_RMS = np.array([0.46, 0.24, 0.46, 0.62, 1.01, 0.06])
"""RMS of the gravity error [N, N m] (6,) of thesis Table 3-1."""

RATE_GAIN = 30000 * RATE_GAIN_PER_K2
"""K2 = 30000 in physical units (thesis 5.6; the scale is inferred)."""

_BEAM, _RELEASE, _STANDING = "beam_horizontal_truth", "release_table_5_2", "position_sine"
_LIGHTEST, _HEAVIEST = 15.0, 140.0


@dataclass(frozen=True)
class Gains:
    """Leg gains at which the claims are looked at [1/s].

    Attributes:
        low: of the original 2 Hz loop (thesis 5.2).
        raised: the higher gain at which the platform vibrates (5.2).
        high: default gain K1 = 20000 with the filter (5.4 to 5.6).
    """

    low: float
    raised: float
    high: float


@dataclass(frozen=True)
class Evaluation:
    """One set of numbers to judge: a plant, its gains, and which claims are asked for."""

    plant: Plant
    gains: Gains
    claims: frozenset[str]


def measure_claims(evaluation: Evaluation) -> dict[str, float]:
    """Value of each claim asked for; groups that nobody asks for are not computed.

    Modes from the linearised structure, growth rates and limits from the Floquet multipliers of
    the whole loop, bandwidths from the leg loop of one axis, the rest from runs.

    Returns:
        mode_highest, mode_lowest, mode_fall [Hz]; bandwidth_low [Hz]; beam_growth [1/s];
        vibration_growth [1/s] and vibration_frequency [Hz] at the raised gain; error_limit,
        feedback_limit [of the payload]; release_cut [1]; rate_gain_bandwidth [1];
        filter_gain_bandwidth [1]; standing_noise [of Table 3-1].

    Raises:
        VesTwinError: a plant that cannot be built or settled.
    """
    plant, gains, asked = evaluation.plant, evaluation.gains, evaluation.claims
    found: dict[str, float] = {}
    for names, measure in _GROUPS:
        if asked & set(names):
            found.update(zip(names, measure(plant, gains), strict=True))
    return {name: value for name, value in found.items() if name in asked}


def _modes(plant: Plant, gains: Gains) -> tuple[float, ...]:
    """Highest and lowest first mode over the heaves, and its fall from the lowest to the highest.

    Modes of the arm on its servo, damped by more than `SERVO`, are no vibration of the platform.
    """
    first = []
    for heave in HEAVES:
        modes = structural_modes(plant, np.array([0, 0, heave, 0, 0, 0]), np.zeros(3))
        light = [m.frequency for m in modes if m.damping < SERVO]
        first.append(min(light, default=NO_MODE))
    return max(first), min(first), first[0] - first[-1]


def _legs(plant: Plant, gains: Gains) -> tuple[float, ...]:
    axis = {place: OneAxis.of(plant, gains.low, place, EDGE, 80.0) for place in FilterPlace}
    high = OneAxis.of(plant, gains.high, FilterPlace.ERROR, EDGE, 80.0)
    low = axis[FilterPlace.NONE].bandwidth()
    return (
        low,
        high.bandwidth(RATE_GAIN) / high.bandwidth() - 1.0,
        axis[FilterPlace.ERROR].bandwidth() / low,
    )


def _beam(plant: Plant, gains: Gains) -> tuple[float, ...]:
    return (_bench(plant, gains.low, FilterPlace.NONE).vibration().growth,)


def _vibration(plant: Plant, gains: Gains) -> tuple[float, ...]:
    mode = _bench(plant, gains.raised, FilterPlace.NONE).vibration()
    return mode.growth, mode.frequency


def _error_limit(plant: Plant, gains: Gains) -> tuple[float, ...]:
    return (_limit(plant, gains.high, FilterPlace.ERROR),)


def _feedback_limit(plant: Plant, gains: Gains) -> tuple[float, ...]:
    return (_limit(plant, gains.high, FilterPlace.FEEDBACK),)


def _limit(plant: Plant, gain: float, place: FilterPlace) -> float:
    """Lowest stable mass over payload, at most that of the heaviest mass tried."""
    limit = _bench(plant, gain, place).mass_limit(_LIGHTEST, _HEAVIEST)
    return min(limit.mass, _HEAVIEST) / limit.payload


def _release(plant: Plant, gains: Gains) -> tuple[float, ...]:
    """Share by which the filter at high gain cuts the error of position after the release."""
    plain = _release_error(plant, gains.low, FilterPlace.NONE)
    return (1.0 - _release_error(plant, gains.high, FilterPlace.ERROR) / plain,)


def _noise(plant: Plant, gains: Gains) -> tuple[float, ...]:
    """Largest RMS of the standing sensor against the gravity wrench, over that of Table 3-1."""
    changes = {
        "run.duration": 4.0, "platform.motion.amplitude": [0.0] * 6, "gravity.method": "truth",
        "legs.gain": gains.low,
    }  # fmt: skip
    run = simulate(Scenario.load(_STANDING, changes), plant)
    error = run["sensor.wrench"] - run["gravity.estimate"]
    return (float(np.max(np.sqrt(np.mean(error**2, axis=0)) / PRINTED_RMS)),)


def _release_error(plant: Plant, gain: float, place: FilterPlace) -> float:
    """RMS distance [m] of the true from the commanded position, six seconds from the release."""
    changes = {
        "run.duration": 6.0, "run.noise": False, "legs.gain": gain, "legs.filter": place.value
    }  # fmt: skip
    run = simulate(Scenario.load(_RELEASE, changes), smooth_readings(plant))
    error = run["truth.pose"][:, :3] - run["platform.command"][:, :3]
    return float(np.sqrt(np.mean(np.sum(error**2, axis=1))))


def _bench(plant: Plant, gain: float, place: FilterPlace) -> StabilityBench:
    changes = {"legs.gain": gain, "legs.filter": place.value}
    return StabilityBench(plant, Scenario.load(_BEAM, changes))


_GROUPS = (
    (("mode_highest", "mode_lowest", "mode_fall"), _modes),
    (("bandwidth_low", "rate_gain_bandwidth", "filter_gain_bandwidth"), _legs),
    (("beam_growth",), _beam),
    (("vibration_growth", "vibration_frequency"), _vibration),
    (("error_limit",), _error_limit),
    (("feedback_limit",), _feedback_limit),
    (("release_cut",), _release),
    (("standing_noise",), _noise),
)

KNOWN_CLAIMS = tuple(name for names, _ in _GROUPS for name in names)
"""Names that a calibration may list."""
