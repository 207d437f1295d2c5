"""laws_left: what a smooth law of what was fed in would still take of what is left."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.bench import Bench
from ves_twin.diagnosis.build_up.discrepancy import apart
from ves_twin.diagnosis.build_up.paired import paired
from ves_twin.diagnosis.build_up.proof import FALSE_SHARE
from ves_twin.diagnosis.build_up.regression import Half

KNOTS = 7
"""Knots of a piecewise linear law, at quantiles of its variable."""

STIFF = 4.0
"""Ridge of its values, in units of noise over what is left: each knot rests on a few rows."""

ALIKE = 0.5
"""Share of a cause's trace that a law of a variable must explain to be of the same motion."""


@dataclass(frozen=True)
class Law:
    """A variable whose smooth law would still help.

    Attributes:
        variable: for instance "q.3" or "rate of q.3".
        channel: number of the channel.
        share: of the square on held-out rows that it takes.
        p: of the paired test.
    """

    variable: str
    channel: int
    share: float
    p: float


def variables(half: Half) -> dict[str, FloatArray]:
    """Every column that is fed in, and its rate, on the grid (rows,)."""
    runs = half.runs
    parts: dict[str, list[FloatArray]] = {}
    for programme, grid in zip(runs.programmes, runs.grids, strict=True):
        for signal, values in programme.drive.items():
            for column in range(values.shape[1]):
                name = signal if values.shape[1] == 1 else f"{signal}.{column + 1}"
                reduced = grid.reduce(values[:, [column]])[:, 0].astype(float)
                parts.setdefault(name, []).append(reduced)
                if not programme.poses and len(reduced) > 2:
                    rate = np.gradient(reduced, grid.step)
                    parts.setdefault(f"rate of {name}", []).append(rate)
    return {name: np.concatenate(pieces) for name, pieces in parts.items()}


def laws_left(bench: Bench, fitted: FloatArray, held: FloatArray) -> list[Law]:
    """Laws of one variable that pass the false-discovery rate over all that were tried.

    Each is fitted to what is left of the fitted half, in that channel's own colour, and judged on
    the held-out half.

    Args:
        bench: with the discrepancy.
        fitted: what is left of the fitted half (rows, c).
        held: what is left of the held-out half (rows, c).
    """
    half = bench.regression.half
    one, two = variables(half), variables(bench.held)
    found = []
    own, there = apart(bench.fit.whitening), bench.own_colour
    left_one = own.apply(fitted.astype(np.float32)).reshape(-1, fitted.shape[1])
    left_two = there.apply(held.astype(np.float32)).reshape(-1, held.shape[1])
    for name in one.keys() & two.keys():
        knots = np.unique(np.quantile(one[name], np.linspace(0.02, 0.98, KNOTS)))
        if len(knots) < 3:
            continue
        for channel in range(held.shape[1]):
            shape = np.zeros((len(knots), *fitted.shape), np.float32)
            shape[..., channel] = hats(one[name], knots)
            design = own.apply(shape).reshape(len(knots), -1, fitted.shape[1])[..., channel].T
            target = left_one[:, channel]
            level = float(np.mean(target**2))
            ridge = STIFF * level / max(float(np.var(fitted[:, channel])), 1e-30)
            values = np.linalg.solve(
                design.T @ design + ridge * np.eye(len(knots)), design.T @ target
            )
            other = np.zeros((1, *held.shape), np.float32)
            other[0, :, channel] = values @ hats(two[name], knots)
            taken = there.apply(other).reshape(-1, held.shape[1])[:, channel]
            before, after = left_two[:, channel], left_two[:, channel] - taken
            rows = bench.whole[:, channel]
            told = paired((before**2 - after**2)[rows], bench.pieces[rows])
            bare = held[:, channel]
            total = max(float(np.sum(bare**2)), 1e-300)  # a column that nothing moves
            share = 1.0 - float(np.sum((bare - other[0, :, channel]) ** 2)) / total
            found.append(Law(name, channel, share, told.p))
    return _kept(found)


def _kept(found: list[Law]) -> list[Law]:
    """Those that Benjamini and Hochberg keep, and that take something of the bare square."""
    ranked = sorted(found, key=lambda law: law.p)
    passed = [k for k, law in enumerate(ranked) if law.p <= FALSE_SHARE * (k + 1) / len(ranked)]
    return [law for law in ranked[: max(passed, default=-1) + 1] if law.share > 0.0]


def same_motion(half: Half, trial: int, channel: int) -> set[str]:
    """Variables of which a smooth law would explain most of a trial's trace in a channel."""
    trace = half.columns[trial][:, :, channel].astype(float)
    found = set()
    for name, values in variables(half).items():
        knots = np.unique(np.quantile(values, np.linspace(0.02, 0.98, KNOTS)))
        if len(knots) < 3:
            continue
        basis = hats(values, knots).T
        for row in trace:
            total = float(np.sum((row - row.mean()) ** 2))
            left = row - basis @ np.linalg.lstsq(basis, row, rcond=None)[0]
            if total > 0.0 and 1.0 - float(left @ left) / total > ALIKE:
                found.add(name)
    return found


def hats(values: FloatArray, knots: FloatArray) -> FloatArray:
    """Piecewise linear shapes that are one at one knot (knots, n)."""
    return np.stack([np.interp(values, knots, row) for row in np.eye(len(knots))])


def by_channel(laws: list[Law], channel: int) -> Mapping[str, float]:
    """Shares of the laws of one channel."""
    return {law.variable: law.share for law in laws if law.channel == channel}
