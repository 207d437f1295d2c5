"""StabilityBench: the admittance loop at rest, its fastest oscillation and its mass limit."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ves_twin.control.admittance import AdmittanceController
from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.build import emulated_of
from ves_twin.simulator.floquet import LoopMode, SampledLoop, smooth_readings
from ves_twin.simulator.simulator import Simulator

RATIO = 1.4
"""Ratio of neighbouring masses tried before the limit is narrowed down."""

CLOSE = 0.001
"""A limit is known to this share of itself."""


@dataclass(frozen=True)
class MassLimit:
    """Lowest stable translational mass of an emulated base.

    Attributes:
        mass: limit [kg]: the range's lower end if all of it is stable, infinite if none is.
        payload: mass above the force sensor [kg].
        frequency: of the oscillation at the limit [Hz].
    """

    mass: float
    payload: float
    frequency: float

    @property
    def share(self) -> float:
        """The limit as a share of the payload."""
        return self.mass / self.payload


class StabilityBench:
    """A scenario's loop, settled and linearised, with emulated bases of any mass put on it.

    The base keeps damping, stiffness and rotational inertia of the scenario's; only its
    translational mass changes, the same along X, Y and Z.

    Args:
        plant: the world; its noise and resolutions are left out.
        scenario: an admittance scenario; its moves and motion are not used.

    Raises:
        InvalidInputError: a scenario without an emulated system.
        VesTwinError: the scenario cannot be built.
    """

    def __init__(self, plant: Plant, scenario: Scenario) -> None:
        sim = Simulator(smooth_readings(plant), still(scenario))
        controller, emulated = sim.computers.controller, emulated_of(scenario)
        if not isinstance(controller, AdmittanceController) or emulated is None:
            raise InvalidInputError(
                "platform.mode", scenario.platform.mode, "a mode that emulates a base"
            )
        self.payload = float(sim.model.body_subtreemass[sim.rig.layout.sensor_body])
        self._controller, self._emulated = controller, emulated
        self._period = sim.rig.clock.admittance * sim.rig.clock.tick
        self._loop = SampledLoop(sim)

    def vibration(self, mass: float | None = None) -> LoopMode:
        """The oscillation that grows fastest, or decays slowest.

        Args:
            mass: translational mass [kg]; the scenario's base if left out.
        """
        base: EmulatedSystem = self._emulated
        self._controller.emulate(base if mass is None else base.with_mass(mass), self._period)
        return self._loop.modes()[0]

    def mass_limit(self, lowest: float, highest: float) -> MassLimit:
        """The mass from which on every heavier one of a range is stable.

        Args:
            lowest: lower end of the range [kg].
            highest: upper end of the range [kg].
        """
        from scipy.optimize import brentq  # slow to import

        def growth(logarithm: float) -> float:
            return self.vibration(float(np.exp(logarithm))).growth

        mode = self.vibration(highest)
        if mode.growth >= 0.0:
            return MassLimit(np.inf, self.payload, mode.frequency)
        count = 1 + int(np.ceil(np.log(highest / lowest) / np.log(RATIO)))
        masses = np.log(np.geomspace(highest, lowest, count))
        for above, below in pairwise(masses):
            if growth(below) >= 0.0:
                limit = float(np.exp(brentq(growth, below, above, xtol=CLOSE)))
                return MassLimit(limit, self.payload, self.vibration(limit).frequency)
        return MassLimit(lowest, self.payload, self.vibration(lowest).frequency)


def still(scenario: Scenario) -> Scenario:
    """The scenario without noise and without moves of the arm."""
    run = scenario.run.model_copy(update={"noise": False})
    arm = scenario.arm.model_copy(update={"moves": ()})
    return scenario.model_copy(update={"run": run, "arm": arm})
