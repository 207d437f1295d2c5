"""Evidence: what was measured, and how its noise is whitened."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.core.types import SingleArray
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.whitening import Whitening


@dataclass(frozen=True)
class Evidence:
    """What was measured, and how its noise is whitened.

    Attributes:
        runs: of the plant.
        measured: channels on the analysis grid (rows, c).
        whitening: of the noise.
        lean: whether fits of laws keep the columns of commissioning errors that they begin with,
            as a machine of many parameters needs.
    """

    runs: Runs
    measured: SingleArray
    whitening: Whitening
    lean: bool = False
