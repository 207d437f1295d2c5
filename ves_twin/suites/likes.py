"""Likes: which causes of a library have the columns of a cause."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.suites.draw import Detectability
from ves_twin.suites.truth import HiddenCause

ALIKE = 0.95
"""Cosine of two traces from which one has the columns of the other: it leaves at most a tenth."""


@dataclass(frozen=True)
class Likes:
    """Traces of all causes at the sizes of a bank, commissioning errors taken out.

    Attributes:
        shown: noise, model error and commissioning errors of the programme.
    """

    shown: Detectability

    def of(self, cause: HiddenCause) -> tuple[str, ...]:
        """Other causes with a cosine of `ALIKE` or more to what this one changes."""
        (own,) = self._traces([self.shown.shift(cause)])
        left = self.shown.metric.project(own)
        labels, traces, lengths = self._library
        cosines = traces @ left / np.maximum(lengths * np.sqrt(max(own @ left, 0.0)), 1e-30)
        near = {name for name, c in zip(labels, cosines, strict=True) if c >= ALIKE}
        return tuple(sorted(near - {cause.label}))

    @cached_property
    def _library(self) -> tuple[list[str], FloatArray, FloatArray]:
        """Label, trace and its length in the metric, of each size of each cause."""
        runs = self.shown.base.runs
        labels, shifts = [], []
        for cause in runs.forward.hypotheses:
            for sizes in cause.departures():
                labels.append(cause.label)
                shifts.append(runs.depart(runs.origin, runs.indices(cause), sizes))
        traces = self._traces(shifts)
        traces[~np.isfinite(traces).all(axis=1)] = 0.0  # a size at which the machine fails
        left = self.shown.metric.project(traces.T).T
        return labels, traces, np.sqrt(np.maximum(np.sum(traces * left, axis=1), 0.0))

    def _traces(self, shifts: list[FloatArray]) -> FloatArray:
        """Whitened changes (m, samples)."""
        base = self.shown.base
        return self.shown.whitening.apply(base.runs.many(shifts) - base.prediction)
