"""asked_of_motion: how much of a law the motion of held-out recordings asks for by itself."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.law.missing import WINDOW, missing_along, smooth_channels, smoothed
from ves_twin.diagnosis.law.place import LawForward
from ves_twin.diagnosis.preprocess import Dataset
from ves_twin.diagnosis.runs import Runs
from ves_twin.effects.law import Law, LawKind, LawShape, joints_of, variable_along

FAR = 3.0
"""Sd that tolerances may go from where they were fitted: a model without any mass and gain would
need no law, nor anything else."""

ROUNDS = 3
"""Times that the size of what is left at each joint is learnt anew."""

SURE = 2.0
"""Sd off that count."""

HALF = 0.5
"""Share of a law below which a motion speaks against it: a false one that fits a simulation may
well be a part of what is there."""


@dataclass(frozen=True)
class Asked:
    """A share of a law's effort, 1 where it is there, and its sd."""

    share: float
    sd: float

    @property
    def most(self) -> float:
        """It is hardly more."""
        return self.share + SURE * self.sd

    @property
    def least(self) -> float:
        """It is hardly less."""
        return self.share - SURE * self.sd


def asked_of_motion(law: Law, found: LawFit, held: Dataset) -> Asked | None:
    """How much of a law inverse dynamics finds in held-out recordings, where that can tell.

    A simulation may follow a motion with a law that is none: over seconds of a lively machine it
    bends where friction or an inertia is off (a pendubot: 19 knots of position, of which the
    motion had 0.05 +- 0.14). What the measured motion asks for beyond the plant, at each joint of
    the law,

        missing = share * law(q, v) + sum_i sd_i * errors_i + rest,

    has no simulation in it. `held` is seen through the same filter as a motion that the plant
    simulates with the law and with noise: where not even that shows the law, nothing is told.

    Args:
        law: an effort, a table or a mesh.
        found: its fit; of a plant with the law among its parameters.
        held: held-out recordings, by the plant without it.

    Returns:
        None where it cannot tell: another kind of law, a motion that is not measured or is fed in,
        too much noise.
    """
    plant, tables = held.runs.forward, (LawShape.TABLE, LawShape.MESH)
    if not isinstance(plant, LawForward) or law.kind is not LawKind.EFFORT:
        return None
    if law.shape not in tables:
        return None
    fit = found.fit
    lawful = replace(held.runs, forward=fit.local.runs.forward)
    point = carried_point(fit.local.runs, lawful, fit.shift)
    rows = np.asarray(lawful.one(point), float)
    noise = np.array([plant.channels[c].sd for c in held.runs.columns])
    noisy = rows + noise * np.random.default_rng(0).standard_normal(rows.shape)
    without = carried_point(fit.local.runs, held.runs, fit.shift)
    shown = _asked(law, held.runs, plant, noisy, without) if np.isfinite(noisy).all() else None
    if shown is None or shown.least < HALF:
        return None
    real = _asked(law, held.runs, plant, np.asarray(held.measured, float), without)
    return None if real is None else Asked(real.share / shown.share, real.sd / shown.share)


def _asked(
    law: Law, runs: Runs, plant: LawForward, rows: FloatArray, point: FloatArray
) -> Asked | None:
    """Of channels (rows, c) as a motion."""
    motion = smooth_channels(runs, rows)
    base = missing_along(runs, plant, motion, point)
    joints = joints_of(law.place)
    if base is None or not {joint for joint, _ in joints} <= base[0].keys():
        return None
    effort = _seen(law.at(*(variable_along(name, base[1]) for name in law.of)), runs)
    columns = [[sign * effort for _, sign in joints]]
    for i in runs.nuisances:
        moved = runs.depart(point, np.array([i]), point[i] + runs.sd[i])
        there = missing_along(runs, plant, motion, moved)
        if there is not None:
            columns.append([base[0][joint] - there[0][joint] for joint, _ in joints])
    design, target = np.array(columns), np.array([base[0][joint] for joint, _ in joints])
    moving = np.any(design != 0.0, axis=(1, 2))
    return _share(design[moving], target) if moving[0] else None


def _seen(effort: FloatArray, runs: Runs) -> FloatArray:
    """An effort (n,) as it is seen in filtered motions, recording by recording."""
    ends = np.cumsum([len(time) - 2 * WINDOW for time in runs.times])
    return np.concatenate([smoothed(part) for part in np.split(effort, ends[:-1])])


def _share(design: FloatArray, target: FloatArray) -> Asked:
    """By least squares of columns (k, joints, n), the first of which is the law."""
    reach = np.append(np.inf, np.full(len(design) - 1, FAR))
    size = np.std(target, axis=1)
    for _ in range(ROUNDS):
        matrix = (design / size[:, None]).reshape(len(design), -1).T
        fit = lsq_linear(matrix, (target / size[:, None]).ravel(), (-reach, reach))
        left = target - np.tensordot(fit.x, design, axes=1)
        size = np.std(left, axis=1) * np.sqrt([_memory(x) for x in left]) + 1e-30
    free = fit.active_mask == 0
    matrix = (design[free] / size[:, None]).reshape(int(np.sum(free)), -1)
    sd = float(np.sqrt(np.linalg.pinv(matrix @ matrix.T)[0, 0]))
    return Asked(float(fit.x[0]), sd)


def _memory(left: FloatArray) -> float:
    """Rows of a residual (n,) that count as one: both sides of its correlation."""
    centred = left - np.mean(left)
    spectrum = np.abs(np.fft.rfft(centred, 2 * len(centred))) ** 2
    memory = np.fft.irfft(spectrum)[: len(centred)]
    memory = memory / max(float(memory[0]), 1e-300)
    stop = int(np.argmax(memory < 0.05)) or len(memory)
    return float(max(1.0, 1.0 + 2.0 * np.sum(memory[1:stop])))
