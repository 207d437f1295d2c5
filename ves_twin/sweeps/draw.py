"""draw_points: the settings of a grid, or of points drawn at random."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import product
from math import prod

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.sweeps.key_value import Value
from ves_twin.sweeps.variation import MOST_VALUES, Span, Variation

Resolve = Callable[[str, object], Value]
"""What a key comes out as, in SI, when it is given a value."""


def draw_points(
    variations: Sequence[Variation], number: int, seed: int, resolve: Resolve
) -> list[dict[str, object]]:
    """Settings of every point.

    Args:
        variations: the varied keys.
        number: how many points are drawn at random; 0 for the whole grid, the last key fastest.
        seed: of the draws. Point k depends on the seed and on k alone, so that a longer sweep
            begins with the points of a shorter one.
        resolve: turns the ends of a range into SI.

    Raises:
        InvalidInputError: a range that cannot be divided or drawn from, or too many points.
    """
    axes = [_axis(variation, number > 0, resolve) for variation in variations]
    keys = [variation.key for variation in variations]
    if number:
        rows = [_drawn(axes, np.random.default_rng([seed, k])) for k in range(number)]
        return [dict(zip(keys, row, strict=True)) for row in rows]
    lists = [axis for axis in axes if not isinstance(axis, tuple)]
    total = prod(map(len, lists))
    if total > MOST_VALUES:
        raise InvalidInputError("--vary", f"a grid of {total} points", f"at most {MOST_VALUES}")
    return [dict(zip(keys, row, strict=True)) for row in product(*lists)]


_Ends = tuple[float, float]


def _axis(variation: Variation, random: bool, resolve: Resolve) -> list[object] | _Ends:
    """The values of a key, or the ends of the range that it is drawn from."""
    span = variation.span
    if span is None:
        return list(variation.values)
    low, high = _ends(variation, span, resolve)
    if span.steps:
        return _steps(variation, low, high, span.steps)
    if not random:
        raise InvalidInputError(
            f"--vary {variation.key}", variation.text, "a list, LO..HI:STEPS, or --random N"
        )
    return low, high


def _ends(variation: Variation, span: Span, resolve: Resolve) -> _Ends:
    low, high = (resolve(variation.key, end) for end in (span.low, span.high))
    for end in (low, high):
        if isinstance(end, bool) or not isinstance(end, int | float):
            raise InvalidInputError(f"--vary {variation.key}", variation.text, "two numbers")
    if not low < high:  # type: ignore[operator]
        raise InvalidInputError(
            f"--vary {variation.key}", variation.text, "a lower end below the upper one"
        )
    return low, high  # type: ignore[return-value]


def _steps(variation: Variation, low: float, high: float, steps: int) -> list[object]:
    values = np.linspace(low, high, steps)
    if not isinstance(low, int):
        return [float(value) for value in values]
    if np.any(values != np.rint(values)):
        raise InvalidInputError(
            f"--vary {variation.key}", variation.text, "steps that fall on whole numbers"
        )
    return [int(value) for value in values]


def _drawn(
    axes: Sequence[list[object] | _Ends], generator: np.random.Generator
) -> tuple[object, ...]:
    return tuple(_one(axis, generator) for axis in axes)


def _one(axis: list[object] | _Ends, generator: np.random.Generator) -> object:
    if not isinstance(axis, tuple):
        return axis[int(generator.integers(len(axis)))]
    low, high = axis
    if isinstance(low, int) and isinstance(high, int):
        return int(generator.integers(low, high, endpoint=True))
    return float(generator.uniform(low, high))
