"""FitContext: what all stages of an explanation work with."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.record.runs import Progress
from ves_twin.diagnosis.settings import Settings


@dataclass(frozen=True)
class FitContext:
    """What all stages work with."""

    first: Assessment
    thresholds: Thresholds
    settings: Settings
    progress: Progress
