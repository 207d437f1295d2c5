"""TunedLegs: gains and filter of a rig's leg loops, changed while it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from ves_twin.control.leg_loop import FEEDBACK, chebyshev_section
from ves_twin.core.types import Block, FloatArray
from ves_twin.simulator.simulator import Simulator

SLEW = 2.0
"""Fastest change of an octave [1/s]; a jump of a gain would jump the valves."""

RATE_GAIN = 0.1
"""Largest gain of the speed term, K2 = 30000 of the thesis [1]. Source: errata E-49."""


@final
@dataclass
class TunedLegs:
    """Changes what the deployed program of the legs has, so that effects on it stay.

    Attributes:
        reference: zero-g motion of the platform, a row a cycle from t = 0 [m, rad] (k, 6).
        at: octaves of the gain and of the filter's edge, and the speed term's gain (3,).
    """

    reference: FloatArray
    at: FloatArray
    _sim: Simulator
    _built: Block

    @staticmethod
    def of(sim: Simulator, reference: FloatArray) -> TunedLegs:
        """The legs of a simulator."""
        return TunedLegs(reference, np.zeros(3), sim, sim.rig.parameters["legs"].copy())

    def hold(self) -> None:
        """Everything as the scenario has it."""
        self.at = np.zeros(3)
        self._sim.rig.parameters["legs"] = self._built

    def command(self, wanted: FloatArray, span: float) -> None:
        """Go towards octaves and speed term (3,), no faster than SLEW; the filter moves with them.

        Args:
            wanted: octaves of the gain, of the filter's edge [1], gain of the speed term [1].
            span: length of the step [s].
        """
        reach = SLEW * span * np.array([1.0, 1.0, RATE_GAIN])
        self.at = self.at + np.clip(wanted - self.at, -reach, reach)
        built, legs = self._built[0], self._sim.rig.parameters["legs"]
        legs["gain"] = built["gain"] * 2.0 ** self.at[0]
        legs["rate_gain"] = max(built["rate_gain"] + self.at[2], 0.0)
        edge = built["edge"] * 2.0 ** self.at[1]
        if edge != legs["edge"][0]:
            legs["edge"] = edge
            self._filter(*chebyshev_section(1.0 / built["period"], edge))

    def _filter(self, numerator: FloatArray, denominator: FloatArray) -> None:
        """Change the section without a bump: its registers as if the input had always been so."""
        rig = self._sim.rig
        legs, state = rig.parameters["legs"][0], rig.state["legs"][0]
        length = rig.board["leg.length"]
        x = length if legs["place"] == FEEDBACK else state["command"] - length
        change = (numerator - denominator) - (legs["numerator"] - legs["denominator"])
        state["z2"] += change[2] * x
        state["z1"] += (change[1] + change[2]) * x
        legs["numerator"], legs["denominator"] = numerator, denominator
