"""Explanation: what the library makes of a record that is not in order."""

from __future__ import annotations

from dataclasses import dataclass

from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.adequacy import EnergyCell
from ves_twin.diagnosis.record.evidence import Evidence


@dataclass(frozen=True)
class Explanation:
    """What the library makes of a record that is not in order.

    Attributes:
        evidence: with the whitening that the best fit's residual shows.
        commissioning: fit of commissioning errors alone.
        fits: by rising chi^2.
        chosen: those that are as good as the best, given its allowance, the best first.
        weights: probability of each of them, given the library.
        adequate: whether what the best leaves is noise.
        score: largest cell score it leaves.
        second: best score of a further cause beside it; None if nobody looked.
        allowance: chi^2 that may stay of what the best explains.
        after: cells with it.
        alone: fits of single causes, where only two together are adequate.
        hopeless: fits that were given up, under the first whitening.
        far: whether no cause takes HOPE of what is there, nor two of them by the screen.
        rough: whether single causes were fitted roughly alone: many must be at work.
    """

    evidence: Evidence
    commissioning: Fit
    fits: tuple[Fit, ...]
    chosen: tuple[Fit, ...]
    weights: tuple[float, ...]
    adequate: bool
    score: float
    second: float | None
    allowance: float
    after: tuple[EnergyCell, ...]
    alone: tuple[Fit, ...] = ()
    hopeless: tuple[Fit, ...] = ()
    far: bool = False
    rough: bool = False

    @property
    def best(self) -> Fit:
        """The most probable one."""
        return self.chosen[0]
