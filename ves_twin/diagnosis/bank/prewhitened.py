"""Prewhitened: a bank filtered once, for all the colours and levels that records claim."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.record.whitening import Whitening


@dataclass(frozen=True)
class Prewhitened:
    """The signatures under the autoregression of a whitening.

    The filters take nine tenths of the time; colour and level, which differ from record to record
    (`Whitening.adapted`), the rest.

    Attributes:
        bank: the signatures.
        whitening: whose filters and mixing are taken.
    """

    bank: SignatureLibrary
    whitening: Whitening

    def columns(self, own: Whitening) -> FloatArray:
        """Columns of the bank's base (samples, k), as a record's own whitening has them."""
        return np.asarray(own.finished(self._columns).T)

    def bent(self, own: Whitening) -> FloatArray:
        """Bent shapes of the bank (samples, b)."""
        return np.asarray(own.finished(self._bent).T)

    @cached_property
    def metric(self) -> Metric:
        """Nuisances as the whitening itself has them."""
        return Metric(self.columns(self.whitening))

    @cached_property
    def _columns(self) -> list[FloatArray]:
        return self.whitening.prewhitened(self.bank.base.columns)

    @cached_property
    def _bent(self) -> list[FloatArray]:
        return self.whitening.prewhitened(self.bank.bent)
