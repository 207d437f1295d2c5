"""Evidence: what was measured, and how its noise is whitened."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.types import SingleArray
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import Whitening


@dataclass(frozen=True)
class Evidence:
    """What was measured, on the analysis grid (rows, c), and how its noise is whitened."""

    runs: Runs
    measured: SingleArray
    whitening: Whitening
