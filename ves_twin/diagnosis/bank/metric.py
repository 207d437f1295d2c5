"""Metric: the inner product of whitened signals with the nuisances marginalised."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.inner import inner


@dataclass(frozen=True)
class Metric:
    """<a, b> = a'b - a'N (I + N'N)^-1 N'b: the inverse covariance of noise plus nuisances.

    By the matrix inversion lemma this is a' (I + N N')^-1 b: what a unit-normal draw of the
    nuisances can explain costs next to nothing.

    Attributes:
        columns: N, whitened change for one sd of each nuisance (samples, k).
    """

    columns: FloatArray

    @cached_property
    def _factor(self) -> tuple[FloatArray, bool]:
        k = self.columns.shape[1]
        factor, lower = cho_factor(np.eye(k) + inner(self.columns, self.columns))
        return factor, bool(lower)

    def project(self, z: FloatArray) -> FloatArray:
        """(I + N N')^-1 z for signals (samples, ...): what the nuisances cannot explain."""
        return np.asarray(z - self.columns @ self.nuisances(z))

    def nuisances(self, z: FloatArray) -> FloatArray:
        """Most probable nuisances in sd (k, ...) if z is noise and nuisances alone."""
        return np.asarray(cho_solve(self._factor, self.columns.T @ z))

    def reduced(self, signals: FloatArray) -> FloatArray:
        """R (k, ...) of signals (samples, ...), so that <a, b> = a'b - R_a' R_b."""
        factor, lower = self._factor
        along = inner(self.columns, signals)
        return np.asarray(solve_triangular(factor, along, trans=0 if lower else 1, lower=lower))
