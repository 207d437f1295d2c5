"""AdmittanceController: the platform moves as the emulated base would under the measured wrench."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.control.controller import ControlTask, PlatformController
from ves_twin.control.platform_law import EMULATES, LAW, emulate
from ves_twin.control.readings import Readings
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import Block, FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem


@final
class AdmittanceController(PlatformController):
    """X(k+1) = Phi X(k) + Gamma W(k): exact zero-order hold of M Y'' + B Y' + K Y = W.

    W is the dynamic wrench of the payload about the platform origin in inertial axes: reading
    less gravity estimate, moved from the sensor to the top and turned by the commanded attitude.
    The command sent at k is the state at k + 1, where the platform should be by then.

    Source: thesis 2.3, 2.4.2, eqs 2.4 to 2.6, errata E-2.
    """

    def __init__(
        self,
        phi: FloatArray,
        gamma: FloatArray,
        sensor_position: FloatArray,
        start: FloatArray,
        home: FloatArray,
        subtract_gravity: bool,
    ) -> None:
        law = self._law = np.zeros(1, LAW)
        law["kind"], law["phi"], law["gamma"] = EMULATES, phi, gamma
        law["position"], law["home"] = sensor_position, home
        law["share"] = 1.0 if subtract_gravity else 0.0
        law["state"][0, :6] = start - home

    @classmethod
    def build(cls, task: ControlTask) -> AdmittanceController:
        """Discretise the task's emulated system at its period."""
        if task.emulated is None:
            raise InvalidInputError("emulated", None, "the name of an emulated system")
        phi, gamma = task.emulated.discretise(task.period)
        position = np.array(task.belief.sensor_position)
        return cls(phi, gamma, position, task.start, task.home, task.subtract_gravity)

    def emulate(self, emulated: EmulatedSystem, period: float) -> None:
        """Emulate another system from now on, in the present position and velocity.

        Args:
            emulated: the system.
            period: time between two cycles [s].
        """
        self._law["phi"], self._law["gamma"] = emulated.discretise(period)

    @property
    def law(self) -> Block:
        """Numbers and state, live."""
        return self._law

    def update(self, time: float, readings: Readings) -> FloatArray:
        """Advance the emulated base by one cycle under the present wrench."""
        state = np.empty(12)
        pose = emulate(self._law, readings.wrench_in_sensor, readings.gravity_in_sensor, state)
        self._law["state"] = state
        return pose

    def snapshot(self) -> object:
        """Position and velocity of the emulated base (12,)."""
        return self._law["state"][0].copy()

    def restore(self, snapshot: object) -> None:
        """Set position and velocity of the emulated base."""
        self._law["state"] = np.asarray(snapshot)
