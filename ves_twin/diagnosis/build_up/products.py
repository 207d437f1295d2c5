"""Products: inner products of all columns of a half, whitened by one discrepancy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, IntArray
from ves_twin.diagnosis.record.whitening import Whitening


@dataclass(frozen=True)
class Products:
    """Inner products of whitened columns.

    Attributes:
        whitening: discrepancy.
        gram: of all columns by all (k, k).
        cross: by the target (k,).
    """

    whitening: Whitening
    gram: FloatArray
    cross: FloatArray

    def of(
        self, rows: IntArray, columns: IntArray, left: FloatArray, right: FloatArray
    ) -> FloatArray:
        """Some of them, in prior sd of both sides."""
        return np.asarray(self.gram[np.ix_(rows, columns)] * np.outer(left, right))
