"""HeldOut: recordings that no fit has seen, and what a fit is worth there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.linearise import Linearisation, linearise
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary, build_bank, cached_bank
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.model.forward import Forward
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import Whitening, whitening_of
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.unseen.held_out_gain import DivergedError, held_out_gain


@dataclass(frozen=True)
class HeldOut:
    """Held-out recordings on the grid, and what a fit is worth there.

    Attributes:
        seen: the recordings.
        whitening: their noise.
        settings: how sure.
        base: their columns where nothing departs; None where none are kept.
    """

    seen: Dataset
    whitening: Whitening
    settings: Settings
    base: Linearisation | None = None

    @staticmethod
    def of(
        forward: Forward,
        recordings: Sequence[Recording],
        standstill: Recording | None,
        settings: Settings,
        workers: Workers,
    ) -> HeldOut:
        """Put them on the grid."""
        seen = preprocess(forward, recordings, workers, settings.rate)
        base = _kept_columns(seen.runs, settings) if settings.sparse and settings.cache else None
        return HeldOut(seen, whitening_of(seen.runs, standstill), settings, base)

    def gain(self, before: Fit, after: Fit) -> Gain | None:
        """Of one fit over another; None where the plant diverges there, as it was fitted."""
        seen, sure, seed = self.seen, self.settings.confidence, self.settings.seed
        there = (seen.runs, seen.measured, self.whitening)
        try:
            return held_out_gain(*there, before, after, sure, seed, self.base)
        except DivergedError:
            return None

    def gains(self, found: Explanation, before: Fit, least: float) -> list[Gain]:
        """Of the best explanation; of its rivals too, where that could be part of the truth.

        None where the best one diverges.

        Args:
            found: the explanation.
            before: the model without a cause, within its tolerances.
            least: share of the excess from which something unexplained leaves a part of the truth.
        """
        first = self.gain(before, found.best)
        if first is None:
            return []
        if found.adequate or first.low is None or first.low <= least:
            return [first]
        rivals = [fit for fit in found.fits if fit is not found.best]
        return [first, *filter(None, (self.gain(before, fit) for fit in rivals))]


def _kept_columns(runs: Runs, settings: Settings) -> Linearisation:
    """Columns of held-out recordings where nothing departs, for all rigs that they are played on.

    Raises:
        FileAccessError: the folder of banks cannot be written.
    """

    def build() -> SignatureLibrary:
        return build_bank(runs, hypotheses=(), base=linearise(runs, runs.origin))

    return cached_bank(runs, settings.cache, build, "columns").base
