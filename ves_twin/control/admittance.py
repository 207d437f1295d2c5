"""AdmittanceController: the platform moves as the emulated base would under the measured wrench."""

from __future__ import annotations

from typing import final

import numpy as np

from ves_twin.control.controller import ControlTask, PlatformController
from ves_twin.control.readings import Readings
from ves_twin.core.compiled import compiled
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles
from ves_twin.mechanics.kinematics.wrenches import rotate_wrench, sensor_to_top


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
        self._phi, self._gamma = phi, gamma
        self._position = sensor_position
        self._home = home
        self._share = 1.0 if subtract_gravity else 0.0
        self._state = np.zeros(12)
        self._state[:6] = start - home

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
        self._phi, self._gamma = emulated.discretise(period)

    def update(self, time: float, readings: Readings) -> FloatArray:
        """Advance the emulated base by one cycle under the present wrench."""
        return _step(
            self._phi,
            self._gamma,
            self._state,
            readings.wrench_in_sensor,
            readings.gravity_in_sensor,
            self._share,
            self._position,
            self._home,
        )

    def snapshot(self) -> object:
        """Position and velocity of the emulated base (12,)."""
        return self._state.copy()

    def restore(self, snapshot: object) -> None:
        """Set position and velocity of the emulated base."""
        self._state[:] = np.asarray(snapshot)


@compiled
def _step(
    phi: FloatArray,
    gamma: FloatArray,
    state: FloatArray,
    reading: FloatArray,
    gravity: FloatArray,
    share: float,
    position: FloatArray,
    home: FloatArray,
) -> FloatArray:
    wrench = sensor_to_top(reading - share * gravity, position)
    wrench = rotate_wrench(matrix_from_angles(home[3:] + state[3:6]), wrench)
    following = np.zeros(12)
    for i in range(12):
        for j in range(12):
            following[i] += phi[i, j] * state[j]
        for j in range(6):
            following[i] += gamma[i, j] * wrench[j]
    state[:] = following
    return home + following[:6]
