"""Study: what every recording of a series is looked at with, kept by programme."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.signature_library import (
    SignatureLibrary,
    bank_key,
    build_bank,
    cached_bank,
)
from ves_twin.diagnosis.fit.assess import assess, pull_limit
from ves_twin.diagnosis.fit.null import Thresholds, cached_thresholds
from ves_twin.diagnosis.model.forward import Forward, Hypothesis
from ves_twin.diagnosis.record.likeness import check_likeness
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.record.whitening import whitening_of
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend.day import Day

FITTED = (-1.0, -np.inf, -1.0)
"""Limits that every record passes, so that its commissioning errors are always fitted by the full
forward: days are held against each other, and what a linearisation leaves would part them."""


@dataclass
class Study:
    """What every recording is looked at with; banks and limits are kept by programme."""

    forward: Forward
    settings: Settings
    standstill: Recording | None
    exclude: tuple[str, ...] = ()
    cause: str = ""
    workers: Workers = field(default_factory=Workers)
    progress: Progress = silent

    def __post_init__(self) -> None:
        self._banks: dict[str, tuple[SignatureLibrary, Thresholds]] = {}

    @property
    def causes(self) -> tuple[Hypothesis, ...]:
        """Causes that can be followed: of one number, and of the machine rather than a stretch.

        Raises:
            InvalidInputError: none is left.
        """
        kept = [h for h in self.forward.hypotheses if self._asked(h)]
        found = tuple(h for h in kept if len(h.parameters) == 1 and not h.transient)
        if not found:
            came = ", ".join(h.label for h in kept) or "none"
            raise InvalidInputError("causes to follow", came, "one of one number, not a drift")
        return found

    def day(self, recording: Recording, time: float, number: int, count: int) -> Day:
        """One recording before any cause is named."""
        seen = preprocess(self.forward, [recording], self.workers, self.settings.rate)
        self.progress(number / count, f"recording {number + 1} of {count}")
        whitening = whitening_of(seen.runs, self.standstill)
        each = replace(self.settings, alpha=self.settings.alpha / count)
        bank, limits = self._known(seen, lambda b: cached_thresholds(b, whitening, each))
        pull = pull_limit(bank, each.alpha)
        look = assess(seen.measured, bank, whitening, *FITTED, limits.bends)
        off = look.exceeds(limits.effect, limits.misfit, pull)
        name = recording.info.scenario or f"recording {number + 1}"
        return Day(name, time, look, limits, off)

    def _known(
        self, seen: Dataset, compute: Callable[[SignatureLibrary], Thresholds]
    ) -> tuple[SignatureLibrary, Thresholds]:
        key = bank_key(seen.runs, b"".join(bad.tobytes() for bad in seen.runs.holes))
        if key in self._banks:
            return self._banks[key]

        def build() -> SignatureLibrary:
            check_likeness(seen, seen.runs.one(seen.runs.origin))
            return build_bank(seen.runs, sparse=self.settings.sparse)

        bank = cached_bank(seen.runs, self.settings.cache, build, self.settings.bank)
        bank = bank.without(tuple(h.label for h in bank.hypotheses if not self._asked(h)))
        self._banks[key] = bank, compute(bank)
        return self._banks[key]

    def _asked(self, hypothesis: Hypothesis) -> bool:
        """Whether a cause is considered."""
        names = (hypothesis.effect, hypothesis.label)
        return self.cause in ("", *names) and not any(name in self.exclude for name in names)
