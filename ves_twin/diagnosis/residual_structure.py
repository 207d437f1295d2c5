"""describe: what stays unexplained: where it is loud, and what it goes along with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.adequacy import Cell
from ves_twin.diagnosis.evidence import Evidence

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
    evidence: Evidence, residual: FloatArray, found: Sequence[Cell], threshold: float
) -> ResidualStructure:
    """The leftover of the best explanation, or of commissioning errors alone.

    Args:
        evidence: the record.
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
    stretches = [c.low for c in loud if c.kind == "time"]
    features = _features(evidence, residual, names) if loud else ()
    onset = min(stretches) if stretches else None
    square = float(np.sum(residual**2) / np.sum(evidence.whitening.freedom))
    return ResidualStructure(square, tuple(told), onset, features)


def _features(
    evidence: Evidence, residual: FloatArray, names: Sequence[str]
) -> tuple[Feature, ...]:
    """Correlations with simple shapes of every measured channel and of time."""
    runs, whitening = evidence.runs, evidence.whitening
    blocks = np.concatenate(whitening.blocks(residual))
    shapes: dict[str, FloatArray] = {"time": np.concatenate(whitening.times())}
    rows = [
        r
        for k, piece in enumerate(runs.slices)
        for r in range(piece.start + whitening.lost(k), piece.stop)
    ]
    for c, name in enumerate(names):
        x = evidence.measured[rows, c].astype(float)
        shapes[name] = x
        shapes[f"sign({name})"] = np.sign(x)
        shapes[f"{name}^2"] = x**2
        shapes[f"{name} |{name}|"] = x * np.abs(x)
        shapes[f"{name}^3"] = x**3
    found = []
    for c, channel in enumerate(names):
        for shape, values in shapes.items():
            spread = float(np.std(values) * np.std(blocks[:, c]))
            if spread > 0.0:
                cov = np.mean((values - values.mean()) * (blocks[:, c] - blocks[:, c].mean()))
                found.append(Feature(channel, shape, float(cov / spread)))
    found.sort(key=lambda feature: -abs(feature.correlation))
    return tuple(found[:LOUDEST])
