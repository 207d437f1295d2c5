"""Observations: what was read at a set of poses at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.gravity.gravity_model import gravity_in_top
from ves_twin.mechanics.kinematics.wrenches import top_to_sensor


@dataclass(frozen=True)
class Observations:
    """One row a pose; nothing moves while it is read.

    Attributes:
        q: measured joint coordinates [rad, m] (n, k).
        angles: orientation that the platform is taken to have [rad] (n, 3).
        signal: sensor signals, nominal units, sensor axes [N, N m] (n, 6).
        load: mass of a known weight hung on the arm at that pose, 0 for none [kg] (n,).
        load_position: where it hangs, in t [m] (n, 3).

    Raises:
        InvalidInputError: rows that do not match, or numbers that are not finite.
    """

    q: FloatArray
    angles: FloatArray
    signal: FloatArray
    load: FloatArray
    load_position: FloatArray

    def __post_init__(self) -> None:
        n = len(self.q)
        shapes = {"angles": (n, 3), "signal": (n, 6), "load": (n,), "load_position": (n, 3)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                came = f"shape {getattr(self, name).shape}"
                raise InvalidInputError(f"{name} of the observations", came, f"shape {shape}")
        for name in ("q", *shapes):
            if not np.all(np.isfinite(getattr(self, name))):
                raise InvalidInputError(f"{name} of the observations", "nan", "finite numbers")

    @staticmethod
    def unloaded(q: FloatArray, angles: FloatArray, signal: FloatArray) -> Observations:
        """Observations without a known weight."""
        return Observations(q, angles, signal, np.zeros(len(q)), np.zeros((len(q), 3)))

    def __len__(self) -> int:
        return len(self.q)

    def joined(self, other: Observations) -> Observations:
        """These rows, then the other ones."""
        fields = ("q", "angles", "signal", "load", "load_position")
        return Observations(
            *(np.concatenate([getattr(self, f), getattr(other, f)]) for f in fields)
        )

    def check_range(self, full_scale: FloatArray) -> None:
        """Raise InvalidInputError where a signal stands at its full scale [N, N m] (6,)."""
        over = np.argwhere(np.abs(self.signal) >= 0.999 * full_scale)
        if len(over):
            pose, axis = (int(v) for v in over[0])
            name = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")[axis]
            raise InvalidInputError(
                f"sensor axis {name} at pose {pose + 1}",
                round(float(self.signal[pose, axis]), 1),
                f"less than its full scale {full_scale[axis]:g}: it is saturated",
            )

    def regressor(
        self, basis: FirstMoments, sensor_position: FloatArray, gravity: float
    ) -> tuple[FloatArray, FloatArray]:
        """The wrench in the sensor, w = B (M_total, P) + l.

        Args:
            basis: which first moments P holds.
            sensor_position: origin of the sensor frame s in t [m] (3,).
            gravity: acceleration of gravity [m/s^2].

        Returns:
            B (n, 6, 1 + p) and the known part l of the weights (n, 6), both in s.
        """
        g = gravity_in_top(self.angles, gravity)
        in_top = np.zeros((len(self), 6, 1 + len(basis.kept)))
        in_top[:, :3, 0] = g
        in_top[:, 3:, 1:] = basis.moment_regressor(self.q, g)
        weight = self.load[:, None] * g
        known = np.hstack([weight, np.cross(self.load_position, weight)])
        turn = to_sensor_matrix(sensor_position)
        return turn @ in_top, known @ turn.T


def to_sensor_matrix(sensor_position: FloatArray) -> FloatArray:
    """X (6, 6) with w_s = X w_t, see `ves_twin.mechanics.kinematics.wrenches.top_to_sensor`."""
    return np.column_stack([top_to_sensor(unit, sensor_position) for unit in np.eye(6)])
