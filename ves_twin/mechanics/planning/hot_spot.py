"""hot_spot_path: the way between two configurations that crosses the least coupling."""

from __future__ import annotations

import itertools
import math

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.mechanics.planning.coupling import coupling_matrix
from ves_twin.mechanics.planning.timed_path import rounded

REACH = 3
"""A step goes up to this many cells along each axis: headings in a plane 18 deg apart or less."""


def hot_spot_path(
    chain: SerialChain,
    base: EmulatedSystem,
    start: FloatArray,
    end: FloatArray,
    low: FloatArray,
    high: FloatArray,
    cells: int = 40,
    straightness: float = 0.1,
) -> FloatArray:
    """Shortest path in the metric of the coupling, on a grid between two configurations.

    The length of a step is sqrt(dq' (Q + s 1) dq): it goes along the lines of minimum energy
    where coupling is high, and through its low areas. s is `straightness` times the mean
    eigenvalue of Q over the grid, the price of a detour. Dijkstra finds it, and the corners of
    the grid are rounded. Joints with equal start and end and `low == high` stay.

    Args:
        chain: the arm.
        base: the flexible base.
        start: joint angles [rad] (n,).
        end: joint angles [rad] (n,).
        low: smallest angle of each joint on the way [rad] (n,).
        high: largest angle [rad] (n,).
        cells: grid cells along each joint that moves.
        straightness: 0 goes any way round for less coupling; large values go straight.

    Returns:
        Joint angles, evenly spaced along the way [rad] (401, n), from start to end exactly.

    Raises:
        InvalidInputError: start or end outside the bounds, or nothing that may move.

    Source: the Hot Spot Method of thesis 4.2, which leaves the search to computer algorithms.
    """
    start, end, low, high = (np.asarray(a, float) for a in (start, end, low, high))
    for name, place in (("start", start), ("end", end)):
        if np.any(place < low) or np.any(place > high):
            came, bounds = np.degrees(place).round(2).tolist(), np.degrees([low, high]).round(2)
            expected = f"degrees within {bounds[0].tolist()} to {bounds[1].tolist()}"
            raise InvalidInputError(f"path {name}", came, expected)
    if not np.any(high > low) or cells < 2:
        raise InvalidInputError("path bounds", (high - low).tolist(), "a joint that may move")
    axes = [
        np.union1d(np.linspace(a, b, cells + 1), [p, r]) if b > a else np.array([a])
        for a, b, p, r in zip(low, high, start, end, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    metric = coupling_matrix(chain, base, grid)
    size = np.trace(metric, axis1=-2, axis2=-1).mean() / chain.joints
    metric += straightness * size * np.eye(chain.joints)
    nodes = grid.reshape(-1, chain.joints)
    first, last = (int(np.argmin(np.sum((nodes - p) ** 2, axis=1))) for p in (start, end))
    _, before = dijkstra(
        _graph(grid, metric), directed=False, indices=first, return_predecessors=True
    )
    way = [last]
    while way[-1] != first:
        way.append(int(before[way[-1]]))
    return rounded(nodes[way[::-1]])


def _graph(grid: FloatArray, metric: FloatArray) -> coo_matrix:
    """Lengths of the steps between neighbours of the grid."""
    shape = grid.shape[:-1]
    number = np.arange(math.prod(shape)).reshape(shape)
    rows, columns, lengths = [], [], []
    reach = REACH if sum(n > 1 for n in shape) < 3 else REACH - 1  # headings multiply
    spans = [range(-reach, reach + 1) if n > 1 else range(1) for n in shape]
    for offset in itertools.product(*spans):
        if offset <= (0,) * len(shape) or math.gcd(*offset) != 1:
            continue
        here = tuple(slice(max(0, -o), n - max(0, o)) for o, n in zip(offset, shape, strict=True))
        there = tuple(slice(max(0, o), n - max(0, -o)) for o, n in zip(offset, shape, strict=True))
        step = grid[there] - grid[here]
        square = np.einsum("...i,...ij,...j->...", step, (metric[here] + metric[there]) / 2, step)
        rows.append(number[here].ravel())
        columns.append(number[there].ravel())
        lengths.append(np.sqrt(square).ravel())
    entries = (np.concatenate(rows), np.concatenate(columns))
    return coo_matrix((np.concatenate(lengths), entries), shape=(number.size, number.size)).tocsr()
