"""sweep_platform: sines of the whole rig in heave, one run a frequency, and what answers them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.procedures.response.sine_fit import PARTS, MeasuredResponse, measure_response
from ves_twin.scenario.schema import Legs, Scenario
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.linear.leg_loop import leg_period
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import simulate

HEAVE = 2
SETTLING = 6.0
"""Time constants of the leg loop, and seconds over its least 1 s, before anything is fitted."""


@dataclass(frozen=True)
class SweepOptions:
    """How the platform is driven.

    Attributes:
        amplitude: of the heave [m].
        rate: how often a new position is commanded [Hz]; once a leg cycle if left out.
        periods: of each sine that are fitted.
        held: whether the platform is held: the valves are shut, the oil carries the legs.
    """

    amplitude: float = 0.002
    rate: float | None = None
    periods: int = 12
    held: bool = False


@dataclass(frozen=True)
class Sweep:
    """What a sweep measured; each a complex gain over the frequencies.

    Attributes:
        platform: true over commanded heave; meaningless with the platform held.
        legs: measured over commanded length, mean of the legs.
        actuator: measured length over the speed asked of the valve [s].
        section: output over input of the digital section in the running leg controller.
    """

    platform: MeasuredResponse
    legs: MeasuredResponse
    actuator: MeasuredResponse
    section: MeasuredResponse


def sweep_platform(
    plant: Plant,
    legs: Legs,
    frequency: Sequence[float],
    options: SweepOptions | None = None,
    progress: Callable[[float, str], None] = lambda share, what: None,
) -> Sweep:
    """Drive the rig in position mode with sines in Z, without noise, and fit the fundamentals.

    The section is seen from outside: its output follows from the valve command, since
    u = (gain y - rate_gain dL/dt) / full_speed, or gain (command - y) with the section on the
    feedback. With the platform held that is the measurement of thesis 5.3.

    Args:
        plant: the world.
        legs: gains and filter place.
        frequency: [Hz].
        options: how the platform is driven.
        progress: called with the share done.

    Raises:
        InvalidInputError: a sine the sampling cannot carry, or a run that did not complete.
    """
    options = options or SweepOptions()
    world = plant.with_values({"hydraulics.full_speed": 0.0}) if options.held else plant
    rows = []
    for done, hertz in enumerate(frequency):
        progress(done / len(frequency), f"{hertz:g} Hz")
        rows.append(_measure(world, legs, float(hertz), options))
    progress(1.0, "done")
    columns = [MeasuredResponse.of(column) for column in zip(*rows, strict=True)]
    return Sweep(*columns)


_Point = tuple[float, complex, float]


def _measure(plant: Plant, legs: Legs, hertz: float, options: SweepOptions) -> tuple[_Point, ...]:
    rate = options.rate or 1.0 / leg_period(plant.parameters)
    if not 0.0 < hertz < 0.4 * rate:
        raise InvalidInputError("frequency", hertz, f"0 to {0.4 * rate:g} Hz")
    fade = max(1.0, 1.0 / hertz)
    start = fade + max(1.0, SETTLING / max(legs.gain, 1.0))
    periods = PARTS * max(1, round(options.periods / PARTS))
    end = start + max(periods / hertz, 0.5)
    scenario = _scenario(legs, hertz, options.amplitude, rate, end, fade)
    run = simulate(scenario, plant)
    if run.info.outcome != Outcome.COMPLETED:
        raise InvalidInputError(
            f"sine of {options.amplitude:g} m at {hertz:g} Hz", run.info.outcome, "a whole run"
        )
    late = run.window(start, end)
    speed = late["valve.command"] * belief_of(scenario).full_speed
    x, y = _section_signals(late, speed, legs)
    command, length = late["leg.command"], late["leg.length"]
    heave = late["platform.command"][:, HEAVE], late["truth.pose"][:, HEAVE]
    pairs = (heave, (command, length), (speed, length), (x, y))
    return tuple((hertz, *measure_response(late.time, *pair, hertz)) for pair in pairs)


def _scenario(
    legs: Legs, hertz: float, height: float, rate: float, duration: float, fade: float
) -> Scenario:
    amplitude = [0.0] * 6
    amplitude[HEAVE] = height
    changes: dict[str, object] = {
        "run.duration": duration,
        "run.log": "leg",
        "run.noise": False,
        "platform.rate": rate,
        "platform.motion.amplitude": amplitude,
        "platform.motion.frequency": [hertz] * 6,
        "platform.motion.fade": fade,
        "legs": legs.model_dump(mode="json"),
    }
    return Scenario.load("position_sine", changes)


def _section_signals(
    run: Recording, speed: FloatArray, legs: Legs
) -> tuple[FloatArray, FloatArray]:
    """Input and output of the digital section (n, 6) [m]; without one, error and error."""
    command, length = run["leg.command"], run["leg.length"]
    period = run.time[1] - run.time[0]
    rate = np.diff(length, axis=0, prepend=length[:1]) / period
    filtered = (speed + legs.rate_gain * rate) / legs.gain
    if legs.filter is FilterPlace.FEEDBACK:
        return length, command - filtered
    return command - length, filtered
