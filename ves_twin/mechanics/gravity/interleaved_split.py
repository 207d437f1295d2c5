"""alternate: the thesis's estimation, mass parameters and calibration matrix in turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.observations import Observations, to_sensor_matrix


@dataclass(frozen=True)
class Pass:
    """What one pass, P and then C, ends with.

    Attributes:
        model: M_total and P.
        calibration: C (6, 6), wrench in SI per signal.
        constant: wrench that is added to C times the signal, for the sensor's zero (6,).
        error: predicted less calibrated wrench at each pose, sensor axes [N, N m] (n, 6).
    """

    model: GravityModel
    calibration: FloatArray
    constant: FloatArray
    error: FloatArray

    @property
    def rms(self) -> FloatArray:
        """Error of each axis over the poses [N, N m] (6,)."""
        return np.asarray(np.sqrt(np.mean(self.error**2, axis=0)))


def alternate(
    observations: Observations,
    basis: FirstMoments,
    sensor_position: FloatArray,
    gravity: float,
    passes: int = 2,
) -> tuple[Pass, ...]:
    """Estimate (M_total, P) with C held, then C with (M_total, P) held, and so on from C = 1.

    M_total by eq. 3.5 from the forces, P by eq. 3.13 from the moments, C by eq. 3.17; each with a
    constant beside it, since the zero of the sensor is not known before the model is.

    Args:
        observations: readings at rest.
        basis: which first moments P holds.
        sensor_position: origin of the sensor in t [m] (3,).
        gravity: acceleration of gravity [m/s^2].
        passes: how many; the thesis takes two.

    Returns:
        The passes in their order.

    Raises:
        InvalidInputError: too few or degenerate poses; says which parameters cannot be seen.

    Source: thesis 3.4.3 to 3.4.6.
    """
    regressor, known = observations.regressor(basis, sensor_position, gravity)
    to_top = np.linalg.inv(to_sensor_matrix(sensor_position))
    in_top, known_in_top = to_top @ regressor, known @ to_top.T
    check_observable(in_top, basis)
    n = len(observations)
    signals = np.column_stack([observations.signal, np.ones(n)])
    mixing = np.vstack([np.eye(6), np.zeros(6)])  # (C', constant) of the pass before
    done: list[Pass] = []
    for _ in range(passes):
        measured = signals @ mixing @ to_top.T - known_in_top
        mass = _with_constant(in_top[:, :3, :1], measured[:, :3])
        moments = _with_constant(in_top[:, 3:, 1:], measured[:, 3:])
        model = GravityModel(basis, float(mass[0]), moments, gravity)
        applied = regressor @ np.concatenate([mass, moments]) + known
        mixing = np.linalg.lstsq(signals, applied, rcond=None)[0]
        error = applied - signals @ mixing
        done.append(Pass(model, mixing[:6].T, mixing[6], error))
    return tuple(done)


def check_observable(regressor_in_top: FloatArray, basis: FirstMoments) -> None:
    """Raise InvalidInputError where (M_total, P) cannot be seen even with C known.

    Args:
        regressor_in_top: B (n, 6, 1 + p) in t.
        basis: names of the parameters.
    """
    n, _, count = regressor_in_top.shape
    constant = np.broadcast_to(np.eye(6), (n, 6, 6))
    stacked = np.concatenate([regressor_in_top, constant], axis=2).reshape(6 * n, count + 6)
    size = np.linalg.norm(stacked, axis=0)
    _, values, vectors = np.linalg.svd(stacked / np.where(size > 0, size, 1.0))
    values = np.concatenate([values, np.zeros(count + 6 - len(values))])
    null = vectors[values < 1e-6 * values[0]]
    if len(null) == 0 and np.all(size > 0):
        return
    seen = np.linalg.norm(null, axis=0) < 1e-4
    names = [
        name
        for name, ok in zip(
            ("M_total", *basis.names), seen[:count] & (size[:count] > 0), strict=True
        )
        if not ok
    ]
    raise InvalidInputError(
        "poses",
        f"{n} poses",
        f"more different ones (joints and tilts); not observable: {', '.join(names)}",
    )


def _with_constant(regressor: FloatArray, measured: FloatArray) -> FloatArray:
    """Least squares of (n, 3, p) against (n, 3) with a constant (3,) beside it; without it (p,)."""
    n, _, p = regressor.shape
    constant = np.broadcast_to(np.eye(3), (n, 3, 3))
    columns = np.concatenate([regressor, constant], axis=2).reshape(3 * n, p + 3)
    return np.asarray(np.linalg.lstsq(columns, measured.ravel(), rcond=None)[0][:p])
