"""confirm_by_run: the growth of a vibration measured in a run, beside what the multipliers say."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.control.admittance import AdmittanceController
from ves_twin.core.errors import InvalidInputError
from ves_twin.plant.plant import Plant
from ves_twin.procedures.stability.growth import oscillation_growth
from ves_twin.procedures.stability.stability_bench import still
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import emulated_of
from ves_twin.simulator.floquet import LoopMode, smooth_readings
from ves_twin.simulator.simulator import Simulator

PUSH = (20.0, 0.01)
"""Force along Y [N] and for how long [s]: a small push, so that growth has room before 0.1 m."""

FADED = 1.0
"""Faster modes than the one looked for have died out by then [s]."""

SILENCE = 3e-5
"""Level down to which an oscillation is followed [m/s^2]: the beat of the clocks (5.28 Hz and its
multiples) on the slow swing after the push leaves 1e-5."""


@dataclass(frozen=True)
class Confirmation:
    """Growth in a run.

    Attributes:
        mass: translational mass of the base [kg].
        rate: measured growth [1/s].
        sd: its standard error [1/s].
        frequency: measured [Hz].
        expected: growth by the Floquet multipliers [1/s].
        verdict: growing, decaying or undecided.
        outcome: how the run ended.
    """

    mass: float
    rate: float
    sd: float
    frequency: float
    expected: float
    verdict: str
    outcome: str


def confirm_by_run(
    plant: Plant, scenario: Scenario, mass: float, mode: LoopMode, duration: float
) -> Confirmation:
    """Push the resting platform, run, and fit the growth of what oscillates about the mode.

    Args:
        plant: the world; its noise and resolutions are left out.
        scenario: an admittance scenario; its moves are not used.
        mass: translational mass of its base [kg].
        mode: what the multipliers say.
        duration: length of the run [s]; it ends earlier where a leg leaves its travel.

    Raises:
        InvalidInputError: a scenario without an emulated system.
    """
    run = scenario.run.model_copy(update={"duration": duration, "log": "admittance"})
    sim = Simulator(smooth_readings(plant), still(scenario.model_copy(update={"run": run})))
    controller, emulated = sim.computers.controller, emulated_of(scenario)
    if not isinstance(controller, AdmittanceController) or emulated is None:
        raise InvalidInputError("platform.mode", scenario.platform.mode, "one that emulates a base")
    clock = sim.rig.clock
    period = clock.admittance * clock.tick
    controller.emulate(emulated.with_mass(mass), period)
    body = sim.model.body("platform/top").id
    sim.data.xfrc_applied[body, 1] = PUSH[0]
    sim.run_to(clock.ticks(PUSH[1]))
    sim.data.xfrc_applied[body] = 0.0
    sim.advance(duration)
    _, signals = sim.recorder.collect()
    # accelerations: beside them the slow swing of the base is small
    moved = np.diff(signals["truth.pose"][int(FADED / period) :, :3], 2, axis=0) / period**2
    band = (0.6 * mode.frequency, min(1.6 * mode.frequency, 0.48 / period))
    outcome = sim.outcome.value if sim.outcome else "completed"
    try:
        growth = oscillation_growth(moved, period, band, floor=SILENCE)
    except InvalidInputError:  # it left the travel before a rate can be fitted
        return Confirmation(mass, np.inf, np.inf, np.nan, mode.growth, "growing", outcome)
    return Confirmation(
        mass, growth.rate, growth.sd, growth.frequency, mode.growth, growth.verdict.value, outcome
    )
