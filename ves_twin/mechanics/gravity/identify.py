"""identify: gain, zero, M_total and P at once by least squares, with what cannot be seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit  # quantile of Student's t; scipy.stats is slow to import

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.first_moments import FirstMoments
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.interleaved_split import alternate
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.mechanics.gravity.sensitivity import MASS, ZERO, Sensitivity

NULL = 1e-7
"""Singular values below this share of the largest one count as zero: round-off of the scaled
Jacobian is 1e-15, while what 10 deg of tilt show of the weakest direction is 1e-4."""

_ROUNDS = 4
"""Rounds of weighting each axis by its own residual; the weights then stand to 1 %."""

_STEPS = 30


@dataclass(frozen=True)
class Identification:
    """The most likely sensor and payload, and how well each number is known.

    Attributes:
        model: M_total and P.
        calibration: C = 1 / A (6, 6), wrench in SI per signal.
        zero: signal under no load [N, N m] (6,).
        noise: sd of a reading about the model [N, N m] (6,).
        residual: signal less model at each pose [N, N m] (n, 6).
        names: of all unknowns: shares of the gain, zero, M_total, P.
        values: of all unknowns.
        sd: of all unknowns; infinite where the data cannot see them.
        freedom: degrees of freedom of the residual.
        hidden: directions that gravity poses cannot see, by name; empty with a known weight.
    """

    model: GravityModel
    calibration: FloatArray
    zero: FloatArray
    noise: FloatArray
    residual: FloatArray
    names: tuple[str, ...]
    values: FloatArray
    sd: FloatArray
    freedom: int
    hidden: tuple[str, ...]

    def half_width(self, level: float = 0.9) -> FloatArray:
        """Half the interval of each unknown at a level of confidence."""
        return np.asarray(self.sd * stdtrit(max(self.freedom // 6, 1), 0.5 + level / 2.0))


def identify(
    observations: Observations,
    basis: FirstMoments,
    sensor_position: FloatArray,
    gravity: float,
    full_scale: FloatArray,
    gain_sd: float | None = None,
) -> Identification:
    """Fit s = A (B x + l) + b to the signals, each axis weighted by its own noise.

    Unlike the alternation, which regresses on noisy signals, it has a covariance. From poses of
    gravity alone five directions stay hidden; `gain_sd` or a known weight in the observations
    pins them. Without either they keep the nominal gain, and their sd is infinite.

    Args:
        observations: readings at rest.
        basis: which first moments P holds.
        sensor_position: origin of the sensor in t [m] (3,).
        gravity: acceleration of gravity [m/s^2].
        full_scale: full scale of the sensor's axes [N, N m] (6,).
        gain_sd: how well the nominal gain is known, sd of each share of full scale.

    Raises:
        InvalidInputError: a saturated sensor; too few or degenerate poses, with what is hidden.
    """
    observations.check_range(full_scale)
    start = alternate(observations, basis, sensor_position, gravity, passes=1)[0]
    regressor, known = observations.regressor(basis, sensor_position, gravity)
    model = Sensitivity(regressor, known, full_scale, basis)
    unknowns = model.start
    unknowns[MASS] = [start.model.total_mass, *start.model.moments]
    hidden = _hidden(model, unknowns, len(observations))
    noise = np.maximum(start.rms, 1e-6 * full_scale)
    for _ in range(_ROUNDS):
        unknowns, jacobian, rank = _fit(model, observations.signal, unknowns, noise, gain_sd)
        residual = observations.signal - model.signal(unknowns)
        freedom = max(residual.size - rank, 6)
        noise = np.sqrt(np.sum(residual**2, axis=0) * 6 / freedom)
        noise = np.maximum(noise, 1e-9 * full_scale)
    sd = _standard_deviations(jacobian)
    fitted = GravityModel(basis, float(unknowns[42]), unknowns[43:].copy(), gravity)
    return Identification(
        model=fitted,
        calibration=np.asarray(np.linalg.inv(model.gain(unknowns)), dtype=float),
        zero=unknowns[ZERO].copy(),
        noise=noise,
        residual=residual,
        names=model.names,
        values=unknowns,
        sd=sd,
        freedom=freedom,
        hidden=hidden,
    )


def null_space(jacobian: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Directions (m, k) of the columns that change nothing, scaled by the columns' size (k,)."""
    size = np.linalg.norm(jacobian, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    values, rows = _spectrum(jacobian / size)
    return rows[values < NULL * values[0]], size


def _spectrum(columns: FloatArray) -> tuple[FloatArray, FloatArray]:
    """All m singular values (zeros too) and right vectors as rows of columns (n, m)."""
    triangle = np.linalg.qr(np.vstack([columns, np.zeros(columns.shape[1:] * 2)]), mode="r")
    _, values, rows = np.linalg.svd(triangle)
    return values, rows


def _hidden(model: Sensitivity, unknowns: FloatArray, count: int) -> tuple[str, ...]:
    """Names of the gauge directions that are there; refuse poses that hide more than those."""
    jacobian = model.jacobian(unknowns) / model.full_scale[:, None]
    null, size = null_space(jacobian.reshape(-1, jacobian.shape[2]))
    named = []
    for name, direction in model.gauge(unknowns).items():
        unit = direction * size / np.linalg.norm(direction * size)
        share = np.linalg.norm(null @ unit)
        if share > 0.999:
            named.append((name, unit))
    known, _ = np.linalg.qr(np.column_stack([unit for _, unit in named] or [np.zeros(len(size))]))
    rest = null - (null @ known) @ known.T
    weight = np.linalg.norm(rest, axis=0)
    if len(null) > len(named):
        worst = [model.names[i] for i in np.argsort(-weight) if weight[i] > 0.05]
        more = f" and {len(worst) - 8} more" if len(worst) > 8 else ""
        raise InvalidInputError(
            "poses",
            f"{count} poses",
            f"more different ones (joints and tilts); not observable: {', '.join(worst[:8])}{more}",
        )
    return tuple(name for name, _ in named)


def _fit(
    model: Sensitivity,
    signal: FloatArray,
    unknowns: FloatArray,
    noise: FloatArray,
    gain_sd: float | None,
) -> tuple[FloatArray, FloatArray, int]:
    """Gauss-Newton; the unknowns, the weighted Jacobian with the prior's rows, the data's rank."""
    unknowns = unknowns.copy()
    prior = np.zeros((0, len(unknowns)))
    if gain_sd is not None:
        prior = np.eye(36, len(unknowns)) / gain_sd
    for _ in range(_STEPS):
        jacobian = (model.jacobian(unknowns) / noise[:, None]).reshape(-1, len(unknowns))
        error = ((signal - model.signal(unknowns)) / noise).ravel()
        stacked = np.vstack([jacobian, prior])
        target = np.concatenate([error, -prior @ unknowns])
        size = np.linalg.norm(stacked, axis=0)
        step = np.linalg.lstsq(stacked / size, target, rcond=NULL)[0] / size
        unknowns += step
        if np.max(np.abs(step * size)) < 1e-6:
            break
    null, _ = null_space(jacobian)
    return unknowns, stacked, jacobian.shape[1] - len(null)


def _standard_deviations(jacobian: FloatArray) -> FloatArray:
    size = np.linalg.norm(jacobian, axis=0)
    values, rows = _spectrum(jacobian / size)
    seen = values >= NULL * values[0]
    variance = np.sum((rows[seen] / values[seen, None]) ** 2, axis=0)
    hidden = np.linalg.norm(rows[~seen], axis=0) > 1e-6
    return np.where(hidden, np.inf, np.sqrt(variance) / size)
