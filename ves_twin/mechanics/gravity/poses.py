"""choose_poses: poses for the identification, at random, on a grid, or by how much they show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.observations import Observations
from ves_twin.mechanics.gravity.sensitivity import MASS, Sensitivity

CANDIDATES = 400
"""Reachable random poses from which the optimised choices are made."""

_SWEEPS = 3
"""Sweeps of exchanges over all poses; the first one brings most."""


class Choice(StrEnum):
    """How poses are chosen."""

    RANDOM = "random"
    GRID = "grid"
    D_OPTIMAL = "d_optimal"
    E_OPTIMAL = "e_optimal"


@dataclass(frozen=True)
class PoseRange:
    """Where poses may lie.

    Attributes:
        joint_low: smallest joint coordinates (k,).
        joint_high: largest joint coordinates (k,).
        tilt: largest angle of the platform about X and Y [rad].
        turn: largest angle about Z [rad].
        reachable: whether joints (k,) and platform angles (3,) can be taken.
    """

    joint_low: FloatArray
    joint_high: FloatArray
    tilt: float
    turn: float
    reachable: Callable[[FloatArray, FloatArray], bool]


@dataclass(frozen=True)
class Conditioning:
    """How well a set of poses shows what gravity poses can show (the gauge left out).

    Attributes:
        condition: condition number of the stacked G, as the thesis's P sees it.
        log_determinant: of the information of all visible directions (D).
        smallest: smallest eigenvalue of it (E), unknowns in units of their usual uncertainty.
    """

    condition: float
    log_determinant: float
    smallest: float


def choose_poses(
    choice: Choice,
    count: int,
    limits: PoseRange,
    model: GravityModel,
    sensor_position: FloatArray,
    full_scale: FloatArray,
    seed: int = 0,
) -> tuple[FloatArray, FloatArray]:
    """Joint coordinates (count, k) and platform angles (count, 3).

    Args:
        choice: how.
        count: how many poses.
        limits: where they may lie.
        model: payload taken for the optimised choices.
        sensor_position: origin of the sensor in t [m] (3,).
        full_scale: full scale of the sensor [N, N m] (6,).
        seed: of the random numbers.

    Raises:
        InvalidInputError: hardly any pose within the limits can be reached.
    """
    rng = np.random.default_rng(seed)
    if choice is Choice.GRID:
        return _grid(count, limits, rng)
    total = count if choice is Choice.RANDOM else max(CANDIDATES, 4 * count)
    q, angles = _random(total, limits, rng)
    if choice is Choice.RANDOM:
        return q, angles
    blocks = _information_rows(model, sensor_position, full_scale, q, angles)
    chosen = _exchange(blocks, count, choice)
    return q[chosen], angles[chosen]


def conditioning(
    model: GravityModel,
    sensor_position: FloatArray,
    full_scale: FloatArray,
    q: FloatArray,
    angles: FloatArray,
) -> Conditioning:
    """How well poses (n, k), (n, 3) show the unknowns."""
    observations = Observations.unloaded(q, angles, np.zeros((len(q), 6)))
    regressor, _ = observations.regressor(model.basis, sensor_position, model.gravity)
    stacked = regressor[:, 3:, 1:].reshape(3 * len(q), -1)
    rows = _information_rows(model, sensor_position, full_scale, q, angles)
    values = np.linalg.eigvalsh(np.einsum("nij,nik->jk", rows, rows))
    return Conditioning(
        float(np.linalg.cond(stacked)),
        float(np.sum(np.log(np.maximum(values, 1e-300)))),
        float(values[0]),
    )


def _random(
    count: int, limits: PoseRange, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    joints, angles = [], []
    span = np.array([limits.tilt, limits.tilt, limits.turn])
    for _ in range(200 * count):
        q = rng.uniform(limits.joint_low, limits.joint_high)
        a = rng.uniform(-span, span)
        if limits.reachable(q, a):
            joints.append(q)
            angles.append(a)
            if len(joints) == count:
                return np.array(joints), np.array(angles)
    raise InvalidInputError(
        "poses", f"{len(joints)} reachable in {200 * count} tries", f"room for {count} poses"
    )


def _grid(count: int, limits: PoseRange, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """A grid of joints and tilts in random order, as fine as it takes, its reachable points."""
    axes = len(limits.joint_low) + 2
    for steps in range(2, 12):
        lines = [
            *(
                np.linspace(a, b, steps)
                for a, b in zip(limits.joint_low, limits.joint_high, strict=True)
            ),
            *(np.linspace(-limits.tilt, limits.tilt, steps),) * 2,
        ]
        if steps**axes < count:
            continue
        picks = rng.permutation(steps**axes)[: 200 * count]
        points = [
            np.array(
                [
                    line[i]
                    for line, i in zip(lines, np.unravel_index(p, (steps,) * axes), strict=True)
                ]
            )
            for p in picks
        ]
        kept = [x for x in points if limits.reachable(x[:-2], np.append(x[-2:], 0.0))]
        if len(kept) >= count:
            rows = np.array(kept[:count])
            return rows[:, :-2], np.column_stack([rows[:, -2:], np.zeros(count)])
    raise InvalidInputError("poses", "a grid", f"limits that hold {count} reachable points")


def _information_rows(
    model: GravityModel,
    sensor_position: FloatArray,
    full_scale: FloatArray,
    q: FloatArray,
    angles: FloatArray,
) -> FloatArray:
    """Rows (n, 6, m) whose products are the information, gauge projected out.

    Signals in 1e-4 of full scale; gains in 1 %, zero in 1 % of full scale, mass parameters in 1 %
    of the largest of them.
    """
    observations = Observations.unloaded(q, angles, np.zeros((len(q), 6)))
    regressor, known = observations.regressor(model.basis, sensor_position, model.gravity)
    sensitivity = Sensitivity(regressor, known, full_scale, model.basis)
    unknowns = sensitivity.start
    unknowns[MASS] = [model.total_mass, *model.moments]
    largest = np.full(len(model.moments), np.max(np.abs(model.moments)))
    unit = 0.01 * np.concatenate([np.ones(36), full_scale, [model.total_mass], largest])
    rows = sensitivity.jacobian(unknowns) * unit / (1e-4 * full_scale[:, None])
    gauge = np.column_stack([d / unit for d in sensitivity.gauge(unknowns).values()])
    visible = np.linalg.qr(gauge, mode="complete")[0][:, gauge.shape[1] :]
    return np.asarray(rows @ visible)


def _exchange(rows: FloatArray, count: int, choice: Choice) -> list[int]:
    """Poses that maximise log det, then for E trade towards the weakest direction."""
    chosen = list(range(count))
    for _ in range(_SWEEPS):
        for k in range(count):
            rest = chosen[:k] + chosen[k + 1 :]
            chosen[k] = _best_addition(rows, rest, chosen[k], choice)
    return chosen


def _best_addition(rows: FloatArray, rest: list[int], now: int, choice: Choice) -> int:
    information = np.einsum("nij,nik->jk", rows[rest], rows[rest])
    information += 1e-9 * np.trace(information) / len(information) * np.eye(len(information))
    if choice is Choice.E_OPTIMAL:
        return _lifts_weakest(rows, information, rest, now)
    inner = rows @ np.linalg.solve(information, rows.transpose(0, 2, 1))
    _, gain = np.linalg.slogdet(np.eye(6) + inner)
    gain[rest] = -np.inf
    return int(np.argmax(gain))


def _lifts_weakest(rows: FloatArray, information: FloatArray, rest: list[int], now: int) -> int:
    """Of the candidates that show the weakest direction most, the one that lifts it most."""
    _, vectors = np.linalg.eigh(information)
    shown = np.sum((rows @ vectors[:, 0]) ** 2, axis=1)
    shown[rest] = -1.0
    tried = [now, *np.argsort(-shown)[:8]]
    lifted = [np.linalg.eigvalsh(information + rows[i].T @ rows[i])[0] for i in tried]
    return int(tried[int(np.argmax(lifted))])
