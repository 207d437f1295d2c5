"""FitJob: one fit, as it travels to a process."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import Linearisation
from ves_twin.diagnosis.fit.refine import ROUGH, Fit, refine
from ves_twin.diagnosis.fit.search import FARTHEST, CauseColumns
from ves_twin.diagnosis.model.forward import Hypothesis
from ves_twin.diagnosis.record.evidence import Evidence

FEW = 5
"""Steps of a rough fit: what is far from the record mimics it by ever smaller ones."""


@dataclass(frozen=True)
class FitJob:
    """What a fit begins with.

    Attributes:
        evidence: what was measured.
        causes: whose parameters are free.
        shift: departures to begin at.
        local: nuisance columns.
        step_share: of the discretisation column, to begin at.
        rough: for a first impression: no more than FEW steps, ended by ROUGH.
        target: chi^2 that it must be able to come down to.
        known: columns of the causes as an earlier fit left them.
        farthest: commissioning sd within which nuisances are held.
    """

    evidence: Evidence
    causes: tuple[Hypothesis, ...]
    shift: FloatArray
    local: Linearisation
    step_share: float
    rough: bool = False
    target: float = np.inf
    known: CauseColumns | None = None
    farthest: float = FARTHEST

    @staticmethod
    def again(
        evidence: Evidence, fit: Fit, local: Linearisation | None = None, target: float = np.inf
    ) -> FitJob:
        """From where a fit ended, under another noise or with other columns."""
        at = (fit.shift, local or fit.local, fit.step_share)
        return FitJob(evidence, fit.causes, *at, target=target, known=fit.columns)

    @staticmethod
    def run(job: FitJob) -> Fit:
        """The fit."""
        at = (job.shift, job.local, 0, job.step_share, job.farthest)
        if job.rough:
            return refine(job.evidence, job.causes, *at, enough=ROUGH, steps=FEW, known=job.known)
        return refine(job.evidence, job.causes, *at, target=job.target, known=job.known)
