"""lone: rows with an empty cell that a line between their neighbours may stand for."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import BoolArray

FEW = 4
"""Rows in a row that may be empty: over five periods a line is drawn, over more it would invent
what happened."""


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
