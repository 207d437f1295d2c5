"""Day: what one recording says of the rig and of every cause, linear about its own best look."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.model.forward import Hypothesis

PROBE = 10.0
"""Size of a cause, in sigma of one recording, at which its signature is taken: visible, and still
near proportional. It does not depend on what was measured."""


@dataclass(frozen=True)
class Day:
    """One recording.

    Attributes:
        name: of the recording.
        time: its date [days from the first].
        look: before any cause is named.
        limits: what noise and commissioning errors do to it.
        off: whether it, alone, is not in order.
    """

    name: str
    time: float
    look: Assessment
    limits: Thresholds
    off: bool

    @property
    def bank(self) -> SignatureLibrary:
        """Signatures of the library in this recording."""
        return self.look.screen.bank

    @cached_property
    def shared(self) -> tuple[str, ...]:
        """Commissioning parameters that the recording has in common with others of the rig."""
        runs = self.bank.base.runs
        axes = [runs.coordinates[int(i)] for i in runs.nuisances]
        return tuple(a.parameter.name for a in axes if a.recording == -1)

    def telling(self, causes: tuple[Hypothesis, ...]) -> Telling:
        """What it tells of the shared parameters and of each cause, its own ones marginalised.

        Args:
            causes: of one parameter each, from the bank's library.
        """
        screen, runs = self.look.screen, self.bank.base.runs
        columns = screen.metric.columns
        axes = [runs.coordinates[int(i)].recording == -1 for i in runs.nuisances]
        own = Metric(columns[:, np.flatnonzero(~np.array([*axes, False]))])
        both = np.concatenate([columns[:, np.flatnonzero(axes)], self._signatures(causes)], axis=1)
        kept = own.project(both)
        return Telling(both.T @ kept, kept.T @ self.look.z, sum(axes))

    def _signatures(self, causes: tuple[Hypothesis, ...]) -> FloatArray:
        """Whitened change for one unit of each cause's parameter (samples, causes)."""
        screen, bank = self.look.screen, self.bank
        found = np.zeros((len(self.look.z), len(causes)))
        for n, cause in enumerate(causes):
            rows = bank.entries(bank.hypotheses.index(cause))
            if len(rows):
                away = np.abs(np.log(np.sqrt(screen.power[rows]) / PROBE))
                best = int(rows[np.argmin(away)])
                shape = screen.shape(best)
                found[:, n] = bank.factor[best] / float(bank.sizes[best][0]) * shape
        return found


@dataclass(frozen=True)
class Telling:
    """Gaussian information of one recording: z' M B and B' M B, M without its own parameters.

    Attributes:
        information: of the shared parameters in commissioning sd, then of each cause's parameter
            in its unit (p + h, p + h).
        score: the same (p + h,).
        shared: p.
    """

    information: FloatArray
    score: FloatArray
    shared: int
