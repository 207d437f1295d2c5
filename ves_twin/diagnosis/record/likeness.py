"""check_likeness: columns that are swapped, turned or in other units than the plant's channels."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.record.preprocess import Dataset

FACTORS = {
    "rad": {"degrees": 180.0 / np.pi},
    "rad/s": {"degrees per second": 180.0 / np.pi},
    "m": {"mm": 1e3, "cm": 1e2, "inches": 1.0 / 0.0254},
    "N": {"pounds": 1.0 / 4.448, "kilograms": 1.0 / 9.81, "kN": 1e-3},
    "N*m": {"inch pounds": 1.0 / 0.113, "N mm": 1e3},
    "Pa": {"bar": 1e-5, "psi": 1.0 / 6895.0, "MPa": 1e-6, "kPa": 1e-3},
}
"""Unit of a channel -> what else it is often written in, and how much larger the number then is;
only where the factor is beyond what a fault does (foot pounds are not)."""

NEAR = 0.1
"""Deviation of a ratio from such a factor, in ln, that is still that factor."""

CLEAR = 0.9
"""Correlation with the prediction that says whose column it is."""

TURNED = 5.0
"""Times that the spread of a turned column may differ from its prediction's: what a wrong model
leaves of a torque may move against it by chance, at a tenth of its size (chosen on the double
pendulum, C0 by the model of A0)."""

WORSE = 10.0
"""How much more of a column its own prediction leaves than another's, if the two are swapped."""

MOVES = 20.0
"""A prediction moves if its spread is so many sd of its noise."""


def check_likeness(seen: Dataset, nominal: SingleArray) -> None:
    """Hold each measured column against the nominal prediction of every channel.

    Faults change a channel; they do not multiply it by 57.3, turn it round or make two channels
    each other's. What is simulated drifts, though: a wrong start or a small constant force turns
    the way of a sled on air round. What looks odd must do so without a parabola in time, too, and
    in half of all recordings.

    Args:
        seen: the recordings.
        nominal: prediction without departures (rows, c).

    Raises:
        InvalidInputError: a column that is another channel's, turned, or in another unit.
    """
    names = [programme.name for programme in seen.runs.programmes]
    every = [list(_oddities(seen, nominal, rows)) for rows in seen.runs.slices]
    counts = Counter((channel, expected) for found in every for channel, _, expected in found)
    for name, found in zip(names, every, strict=True):
        for channel, came, expected in found:
            if 2 * counts[channel, expected] >= len(names):
                raise InvalidInputError(f"{channel} of {name}", came, expected)


def _oddities(seen: Dataset, nominal: SingleArray, rows: slice) -> Iterator[tuple[str, str, str]]:
    channels = [seen.runs.forward.channels[c] for c in seen.runs.columns]
    measured, expected = _centred(seen.measured[rows]), _centred(nominal[rows])
    spread, should = np.std(measured, axis=0), np.std(expected, axis=0)
    match = _correlation(measured, expected)
    bare = _correlation(_without_drift(measured), _without_drift(expected))
    moving = np.flatnonzero(should > MOVES * np.array([channel.sd for channel in channels]))
    best = {i: max(moving, key=lambda j: abs(match[i, j])) for i in moving}
    left = 1.0 - match**2
    for i in moving:
        own, other = channels[i], best[i]
        swapped = other != i and best[other] != other
        swapped = swapped and min(abs(match[i, other]), abs(bare[i, other])) > CLEAR
        if swapped and left[i, i] > WORSE * left[i, other]:
            text = f"a column that moves as {channels[other].name} should"
            yield own.name, text, "its own; columns look swapped"
        elif (
            max(match[i, i], bare[i, i]) < -CLEAR and 1.0 / TURNED < spread[i] / should[i] < TURNED
        ):
            came = _turned(seen.measured[rows][:, i], nominal[rows][:, i], own.unit)
            yield own.name, came, "the other sign"
        elif match[i, i] > CLEAR:
            ratio = float(spread[i] / should[i])
            for word, factor in FACTORS.get(own.unit, {}).items():
                if abs(np.log(ratio / factor)) < NEAR:
                    came = f"{ratio:.3g} times what the plant predicts"
                    yield own.name, came, f"{own.unit}; it looks like {word}"


def _turned(measured: SingleArray, nominal: SingleArray, unit: str) -> str:
    """Words for a column that is turned, with the offset that its line has beside."""
    slope, beside = np.polyfit(nominal, measured, 1)
    there = f"{slope:.3g} times it, and {beside:.2g} {unit.removeprefix('1')}".strip()
    return f"a column that moves against the prediction: {there} beside"


def _centred(rows: SingleArray) -> FloatArray:
    return np.asarray(rows - np.mean(rows, axis=0, dtype=float))


def _without_drift(rows: FloatArray) -> FloatArray:
    """Columns (n, c) less a parabola in time each."""
    time = np.linspace(-1.0, 1.0, len(rows))
    shapes = np.stack([np.ones_like(time), time, time**2], axis=1)
    return np.asarray(rows - shapes @ np.linalg.lstsq(shapes, rows, rcond=None)[0])


def _correlation(measured: FloatArray, expected: FloatArray) -> FloatArray:
    one, two = (x / np.maximum(np.linalg.norm(x, axis=0), 1e-30) for x in (measured, expected))
    return np.asarray(one.T @ two)
