"""asked_of_motion: how much of a law the motion of held-out recordings asks for by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import carried_point
from ves_twin.diagnosis.law.fit_law import LawFit
from ves_twin.diagnosis.model.law_forward import LawForward
from ves_twin.diagnosis.record.by_motion import along_motion, by_motion, missing_at
from ves_twin.diagnosis.record.preprocess import Dataset
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
    rows = lawful.one(point)
    noise = np.array([plant.channels[c].sd for c in held.runs.columns])
    rng = np.random.default_rng(0)
    noisy = np.asarray(rows + noise * rng.standard_normal(rows.shape), np.float32)
    without = carried_point(fit.local.runs, held.runs, fit.shift)
    shown = _asked(law, replace(held, measured=noisy), without) if np.isfinite(rows).all() else None
    if shown is None or shown.least < HALF:
        return None
    real = _asked(law, held, without)
    return None if real is None else Asked(real.share / shown.share, real.sd / shown.share)


def _asked(law: Law, seen: Dataset, point: FloatArray) -> Asked | None:
    """Of recordings at a point of their plant."""
    told = by_motion(seen)
    if told is None:
        return None
    runs, joints = told.runs, joints_of(law.place)
    names = [channel.name for channel in runs.forward.channels]
    at = [names.index(missing_at(joint)) for joint, _ in joints if missing_at(joint) in names]
    if len(at) < len(joints):
        return None

    def effort(path: Mapping[str, FloatArray]) -> FloatArray:
        one = law.at(*(variable_along(name, path) for name in law.of))
        return np.stack([sign * one for _, sign in joints], axis=1)

    base = runs.one(point)[:, at]
    moved = [runs.depart(point, np.array([i]), point[i] + runs.sd[i]) for i in runs.nuisances]
    design = np.stack(
        [along_motion(told, point, effort), *(runs.one(there)[:, at] - base for there in moved)]
    )
    rows = runs.kept[:, at[0]] & np.isfinite(design).all(axis=(0, 2))
    moving = np.any(design[:, rows] != 0.0, axis=(1, 2))
    if not moving[0]:
        return None
    return _share(design[moving][:, rows].transpose(0, 2, 1), -base[rows].T.astype(float))


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
