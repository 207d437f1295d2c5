"""describe: what stays unexplained: where it is loud, and what it goes along with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.record.adequacy import EnergyCell
from ves_twin.diagnosis.record.change_point import change_point
from ves_twin.diagnosis.record.evidence import Evidence

LOUDEST = 6
"""Cells and features that are told."""


@dataclass(frozen=True)
class Loud:
    """A cell beyond what noise does: channel, band [Hz] or stretch [s], excess energy in it."""

    recording: int
    channel: str
    kind: str
    low: float
    high: float
    score: float
    share: float


@dataclass(frozen=True)
class Feature:
    """A shape that a channel's leftover goes along with: its correlation, -1 to 1."""

    channel: str
    shape: str
    correlation: float


@dataclass(frozen=True)
class ResidualStructure:
    """What is left: mean z^2 (1 is noise), loud cells, first time [s] of a loud stretch, shapes."""

    mean_square: float
    loud: tuple[Loud, ...]
    onset: float | None
    features: tuple[Feature, ...]


def describe(
    evidence: Evidence,
    predicted: SingleArray,
    residual: FloatArray,
    found: Sequence[EnergyCell],
    threshold: float,
) -> ResidualStructure:
    """The leftover of the best explanation, or of commissioning errors alone.

    Args:
        evidence: the record.
        predicted: channels by that explanation (rows, c).
        residual: whitened (samples,).
        found: its cells.
        threshold: score that noise does not pass.
    """
    runs = evidence.runs
    names = [runs.forward.channels[c].name for c in runs.columns]
    total = sum(max(c.energy - c.freedom, 0.0) for c in found if c.kind == "time")
    loud = sorted((c for c in found if c.score() > threshold), key=lambda c: -c.score())
    told = [
        Loud(
            c.recording + 1,
            names[c.channel],
            c.kind,
            c.low,
            c.high,
            c.score(),
            max(c.energy - c.freedom, 0.0) / max(total, 1e-9),
        )
        for c in loud[:LOUDEST]
    ]
    features = _features(evidence, predicted, residual, names) if loud else ()
    onset = _onset(evidence, residual, [c for c in loud if c.kind == "time"])
    square = float(np.sum(residual**2) / np.sum(evidence.whitening.freedom))
    return ResidualStructure(square, tuple(told), onset, features)


def _onset(evidence: Evidence, residual: FloatArray, loud: Sequence[EnergyCell]) -> float | None:
    """Time [s] at which the loudest channel gets loud: by rows, else where a stretch begins.

    A residual that is loud from the start has no change: its first stretch begins the recording.
    """
    if not loud:
        return None
    worst, whitening = loud[0], evidence.whitening
    kept = whitening.blocks(whitening.freedom)[worst.recording][:, worst.channel] > 0.0
    rows = whitening.blocks(residual)[worst.recording][:, worst.channel]
    at = change_point(np.where(kept, rows, np.nan))
    if at is None:
        return min(cell.low for cell in loud)
    return float(whitening.times()[worst.recording][at])


def _features(
    evidence: Evidence, predicted: SingleArray, residual: FloatArray, names: Sequence[str]
) -> tuple[Feature, ...]:
    """Correlations with simple shapes of every channel as predicted, of its rate and of time.

    Measured channels hold what is left themselves, and would go along with it.

    Of the shapes of one source only the best is told: they are alike among themselves.
    """
    blocks = np.concatenate(evidence.whitening.blocks(residual))
    shapes, found = list(_shapes(evidence, predicted, names)), list[Feature]()
    for c, channel in enumerate(names):
        best: dict[str, Feature] = {}
        for source, shape, values in shapes:
            spread = float(np.std(values) * np.std(blocks[:, c]))
            if spread > 0.0:
                cov = np.mean((values - values.mean()) * (blocks[:, c] - blocks[:, c].mean()))
                one = Feature(channel, shape, float(cov / spread))
                if source not in best or abs(one.correlation) > abs(best[source].correlation):
                    best[source] = one
        found += best.values()
    found.sort(key=lambda feature: -abs(feature.correlation))
    return tuple(found[:LOUDEST])


def _shapes(
    evidence: Evidence, predicted: SingleArray, names: Sequence[str]
) -> Iterator[tuple[str, str, FloatArray]]:
    """What it is made of, its name, its values on the whitened rows of all recordings."""
    whitening = evidence.whitening
    pieces = [(piece, whitening.lost(k)) for k, piece in enumerate(evidence.runs.slices)]
    yield "time", "time", np.concatenate(whitening.times())
    for c, name in enumerate(names):
        if not np.any(evidence.measured[:, c]):  # what a motion lacks is its own error
            continue
        column = [predicted[piece, c].astype(float) for piece, _ in pieces]
        x, rate = (
            np.concatenate([rows[lost:] for rows, (_, lost) in zip(of, pieces, strict=True)])
            for of in (column, [np.gradient(rows) for rows in column])
        )
        yield name, name, x
        yield name, f"sign({name})", np.sign(x)
        yield name, f"{name}^2", x**2
        yield name, f"{name} |{name}|", x * np.abs(x)
        yield name, f"{name}^3", x**3
        yield f"rate of {name}", f"rate of {name}", rate
        yield f"rate of {name}", f"sign(rate of {name})", np.sign(rate)
        yield f"rate of {name}", f"rate |rate| of {name}", rate * np.abs(rate)
