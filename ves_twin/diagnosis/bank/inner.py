"""inner: inner products of columns, most of which are nothing in most of the recordings."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import BoolArray, FloatArray

STRETCH = 1024
"""Samples that are looked at together for columns that are nothing there."""


def inner(left: FloatArray, right: FloatArray) -> FloatArray:
    """L'R of columns (samples, k) and (samples, m): (k, m), by stretches where some are nothing.

    Where each recording begins is a nuisance of its own, and changes no other one: of a log that is
    simulated in 33 pieces a fourteenth of all columns is not zero.
    """
    starts = np.arange(0, len(left), STRETCH)
    here = _used(left, starts)
    there = here if right is left else _used(right, starts)
    if np.all(here) and np.all(there):
        return np.asarray(left.T @ right)
    found = np.zeros((left.shape[1], right.shape[1]))
    for n, start in enumerate(starts):
        rows, one, two = slice(start, start + STRETCH), here[n], there[n]
        ours = left[rows, np.flatnonzero(one)]
        theirs = ours if right is left else right[rows, np.flatnonzero(two)]
        found[np.ix_(one, two)] += ours.T @ theirs
    return found


def _used(columns: FloatArray, starts: np.ndarray) -> BoolArray:
    """Whether each column has a number in each stretch (stretches, k)."""
    if not columns.size:
        return np.ones((len(starts), columns.shape[1]), bool)
    return np.asarray(np.logical_or.reduceat(columns != 0.0, starts, axis=0))
