"""lone, filled: a few rows without a number, which their neighbours may stand for."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray

FEW = 4
"""Rows together that may lack a number: over more a line would invent what happened."""

MOST = 0.1
"""Share of its rows that a column may lack; of more it is a slower signal, not a log with holes."""


def lone(empty: BoolArray) -> BoolArray:
    """Which empty rows stand in stretches of FEW at most; those of longer ones are a gap.

    Args:
        empty: whether a row lacks a number (n,).
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[0], empty.astype(int), [0]])))
    found = np.zeros(len(empty), bool)
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        found[start:stop] = stop - start <= FEW
    return found


def filled(values: FloatArray, empty: BoolArray, held: bool) -> FloatArray:
    """Values with those that are missing straight between their neighbours, or as they were before.

    Args:
        values: at even rows (n,).
        empty: rows to fill (n,).
        held: whether the newest value stands until the next one comes, as of a command.
    """
    there, rows = np.flatnonzero(~empty), np.arange(len(values))
    if not len(there) or len(there) == len(values):
        return values
    if held:
        return np.asarray(values[there[np.maximum(np.searchsorted(there, rows, "right") - 1, 0)]])
    return np.asarray(np.where(empty, np.interp(rows, there, values[there]), values))
