"""Feasible: the linearised region in which all claims hold: its middle, widths and conflicts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray

OPPOSED = -0.5
"""Cosine of two margins' gradients below which they pull against each other."""

TIGHT = 2.0
"""A margin above this is no constraint worth naming."""


@dataclass(frozen=True)
class Feasible:
    """Margins m + J d of claims, linear in the change d of log-parameters; a claim holds for m > 0.

    Attributes:
        names: of the margins.
        margins: at d = 0 (n,).
        jacobian: d margin / d log-parameter (n, p).
    """

    names: tuple[str, ...]
    margins: FloatArray
    jacobian: FloatArray

    def step(self, lowest: FloatArray, highest: FloatArray, reach: float) -> FloatArray:
        """The change (p,) with the largest worst margin, margins above 1 counting as 1.

        Maximises t in m + J d >= t, t <= 1, by linear programming, less a small price on the
        length of the change, so that what matters nothing stays.

        Args:
            lowest: smallest change allowed (p,).
            highest: largest change allowed (p,).
            reach: largest change of any one, for which the linearisation is trusted.
        """
        from scipy.optimize import linprog  # slow to import

        n, p = self.jacobian.shape
        price = 0.02
        # d = rise - fall, both >= 0, so that the price is on |d|
        cost = np.concatenate([np.full(2 * p, price), [-1.0]])
        rows = np.column_stack([-self.jacobian, self.jacobian, np.ones(n)])
        rise = np.clip(np.minimum(highest, reach), 0.0, None)
        fall = np.clip(np.minimum(-lowest, reach), 0.0, None)
        bounds = [*((0.0, high) for high in (*rise, *fall)), (None, 1.0)]
        solution = linprog(cost, A_ub=rows, b_ub=self.margins, bounds=bounds)
        if not solution.success:
            return np.zeros(p)
        return np.asarray(solution.x[:p] - solution.x[p : 2 * p])

    def width(self, parameter: int) -> tuple[float, float]:
        """Change of one log-parameter alone, down and up, over which every claim holds; nan: none.

        Args:
            parameter: index.
        """
        low, high = -np.inf, np.inf
        for margin, slope in zip(self.margins, self.jacobian[:, parameter], strict=True):
            if margin < 0.0:
                return np.nan, np.nan
            if slope > 0.0:
                low = max(low, -margin / slope)
            elif slope < 0.0:
                high = min(high, -margin / slope)
        return float(low), float(high)

    def conflicts(self) -> list[tuple[str, str, float]]:
        """Pairs of tight margins that pull against each other, most opposed first, and the cosine.

        The two bounds of one claim are no conflict.
        """
        length = np.linalg.norm(self.jacobian, axis=1) * (self.margins < TIGHT)
        found = []
        for i in range(len(self.names)):
            for j in range(i):
                if length[i] * length[j] > 0.0 and _claim(self.names[i]) != _claim(self.names[j]):
                    cosine = float(self.jacobian[i] @ self.jacobian[j] / (length[i] * length[j]))
                    if cosine < OPPOSED:
                        found.append((self.names[j], self.names[i], cosine))
        return sorted(found, key=lambda pair: pair[2])


def _claim(margin: str) -> str:
    return margin.rsplit(" ", 1)[0]
