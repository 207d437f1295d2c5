"""Settings: the few numbers a diagnosis is run with."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.budget import Budget
from ves_twin.diagnosis.model.grid import RATE


@dataclass(frozen=True)
class Settings:
    """How sure, how many, how much is allowed.

    Attributes:
        alpha: probability that a rig with nothing wrong passes a threshold.
        nulls: rigs of the null distribution.
        simulated_nulls: whether those rigs are simulated and fitted, or drawn from the
            linearisation, which costs no runs.
        candidates: hypotheses that are fitted with the full forward.
        rounds: linearisations at most at a fit.
        model_error: relative error that the simulated change due to a cause may have. Of a cause
            that explains chi^2, its square times that may stay, in each cell and in any score.
        odds: a rival less probable than the best by more than this is not named beside it.
        confidence: of intervals.
        workers: processes.
        cache: folder for banks and thresholds; none if None.
        seed: of the null distribution.
        causes: that may be named together; beyond two only on held-out recordings.
        rate: of the analysis grid [Hz].
        sparse: whether banks are built with fewer runs, and rough fits go on with what they have,
            as a machine of many parameters needs.
        laws: whether a law is looked for where no cause explains the record, and the plant can
            have laws; None where runs are cheap.
        minutes: that a diagnosis may take, of processor time in one process, of the clock in
            several; what it then leaves out it says.
    """

    alpha: float = 0.002
    nulls: int = 100
    simulated_nulls: bool = True
    candidates: int = 6
    rounds: int = 3
    model_error: float = 0.02
    odds: float = 100.0
    confidence: float = 0.90
    workers: int = 1
    cache: Path | None = None
    seed: int = 0
    causes: int = 2
    rate: float = RATE
    sparse: bool = False
    laws: bool | None = False
    minutes: float = 30.0

    @property
    def budget(self) -> Budget:
        """Of a diagnosis that begins now."""
        return Budget(self.minutes, time.process_time if self.workers == 1 else time.monotonic)

    @property
    def bank(self) -> str:
        """Sort of bank, where it is not the full one."""
        return "sparse" if self.sparse else ""
