"""CouplingMap: a cross-section of the coupling over two joints, the others held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.chain import SerialChain
from ves_twin.mechanics.planning.coupling import coupling_matrix


@dataclass(frozen=True)
class CouplingMap:
    """Coupling over a grid of two joints.

    Attributes:
        joints: the two joints, numbered from 0.
        first: angles of the first one [rad] (a,).
        second: angles of the second one [rad] (b,).
        matrix: Q restricted to the two joints (a, b, 2, 2).
        low: unit direction of least energy at each place, first component not negative (a, b, 2).
        least: coupling along it, the square root of the smaller eigenvalue (a, b).
        most: coupling across it, the square root of the larger one: the darkness of the map (a, b).
    """

    joints: tuple[int, int]
    first: FloatArray
    second: FloatArray
    matrix: FloatArray
    low: FloatArray
    least: FloatArray
    most: FloatArray

    def line(self, start: FloatArray, step: float, longest: int = 2000) -> FloatArray:
        """The line of minimum energy through a place, both ways to the edge of the map.

        Follows the eigenvector of the smaller eigenvalue by the midpoint rule.

        Args:
            start: angles of the two joints [rad] (2,).
            step: length of one step [rad].
            longest: most steps each way.

        Returns:
            Places on the line, in order [rad] (k, 2).
        """
        halves = []
        for sign in (-1.0, 1.0):
            place = np.asarray(start, float)
            heading = sign * self._low_at(place)
            points = []
            for _ in range(longest):
                middle = self._low_at(place + step / 2 * heading)
                heading = middle * (1.0 if middle @ heading >= 0 else -1.0)
                place = place + step * heading
                if not self._inside(place):
                    break
                points.append(place)
            halves.append(points)
        return np.array([*halves[0][::-1], np.asarray(start, float), *halves[1]])

    def _low_at(self, place: FloatArray) -> FloatArray:
        x = np.interp(place[0], self.first, np.arange(len(self.first)))
        y = np.interp(place[1], self.second, np.arange(len(self.second)))
        i, j = min(int(x), len(self.first) - 2), min(int(y), len(self.second) - 2)
        u, v = x - i, y - j
        corners = self.matrix[i : i + 2, j : j + 2]
        weights = np.outer([1 - u, u], [1 - v, v])
        blended = np.einsum("ab,abij->ij", weights, corners)
        return np.asarray(np.linalg.eigh(blended)[1][:, 0])

    def _inside(self, place: FloatArray) -> bool:
        return bool(
            self.first[0] <= place[0] <= self.first[-1]
            and self.second[0] <= place[1] <= self.second[-1]
        )


def coupling_map(
    chain: SerialChain,
    base: EmulatedSystem,
    joints: tuple[int, int],
    first: FloatArray,
    second: FloatArray,
    held: FloatArray,
) -> CouplingMap:
    """The coupling map of two joints.

    Args:
        chain: the arm.
        base: the flexible base.
        joints: the two joints, numbered from 0.
        first: rising angles of the first [rad] (a,).
        second: rising angles of the second [rad] (b,).
        held: angles at which all joints are held; those of the two do not count [rad] (n,).

    Raises:
        InvalidInputError: joints that the arm does not have, or fewer than two angles.

    Source: thesis 4.2, Fig. 4-1.
    """
    i, j = joints
    if i == j or not all(0 <= k < chain.joints for k in joints):
        expected = f"two different ones of 1 to {chain.joints}"
        raise InvalidInputError("map joints", (i + 1, j + 1), expected)
    for name, angles in (("first", first), ("second", second)):
        if len(angles) < 2 or np.any(np.diff(angles) <= 0):
            raise InvalidInputError(f"map angles, {name}", list(angles), "two or more, rising")
    q = np.broadcast_to(np.asarray(held, float), (len(first), len(second), chain.joints)).copy()
    q[..., i], q[..., j] = np.asarray(first)[:, None], np.asarray(second)[None, :]
    matrix = coupling_matrix(chain, base, q)[..., [[i, i], [j, j]], [[i, j], [i, j]]]
    values, vectors = np.linalg.eigh(matrix)
    low = vectors[..., 0]
    low = low * np.where(low[..., :1] < 0, -1.0, 1.0)
    sizes = np.sqrt(np.maximum(values, 0.0))
    return CouplingMap(
        joints, np.asarray(first), np.asarray(second), matrix, low, sizes[..., 0], sizes[..., 1]
    )
