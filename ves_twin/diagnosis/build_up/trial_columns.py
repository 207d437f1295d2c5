"""TrialColumns: what trials add to the channels about a point, simulated when it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.build_up.trials import Trial, columns_of
from ves_twin.diagnosis.record.runs import Progress, Runs, silent


@dataclass(frozen=True)
class TrialColumns:
    """Columns (width, rows, c) of trials about a point.

    Of held-out recordings those of a few trials are asked for, which a selection chose.

    Attributes:
        runs: of the recordings.
        point: departures (coordinates,).
        trials: all of them.
        prediction: channels at the point (rows, c).
        progress: told how far it is.
        known: columns by a trial's number.
    """

    runs: Runs
    point: FloatArray
    trials: Sequence[Trial]
    prediction: SingleArray
    progress: Progress = silent
    known: dict[int, SingleArray] = field(default_factory=dict)

    def of(self, numbers: Sequence[int]) -> list[SingleArray]:
        """Of some trials, together where they are simulated."""
        new = [n for n in numbers if n not in self.known]
        if new:
            asked = [self.trials[n] for n in new]
            found = columns_of(self.runs, self.point, asked, self.progress, self.prediction)
            self.known.update(zip(new, found, strict=True))
        return [self.known[n] for n in numbers]

    def failed(self, numbers: Sequence[int]) -> list[int]:
        """Those with which a simulation of these recordings breaks off."""
        found = self.of(numbers)
        return [n for n, c in zip(numbers, found, strict=True) if not np.all(np.isfinite(c))]

    def __getitem__(self, number: int) -> SingleArray:
        return self.of([number])[0]
