"""looked: the thresholds of a bank, and a record before any cause held against them."""

from __future__ import annotations

from dataclasses import replace

from ves_twin.core.types import SingleArray
from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.fit.assess import Assessment, assess, pull_limit
from ves_twin.diagnosis.fit.null import Thresholds, cached_thresholds, noise_thresholds
from ves_twin.diagnosis.record.runs import Progress
from ves_twin.diagnosis.record.whitening import Whitening
from ves_twin.diagnosis.settings import Settings

OUT_OF_STEP = 10.0
"""Times what noise does that rigs in order leave, from which they tell nothing of a record: some 40
sigma in a band or stretch of time. Chosen on simulated lively arms, which leave 80 to 3 600; other
machines of the tests leave 5 to 34."""


def looked(
    measured: SingleArray,
    bank: SignatureLibrary,
    whitening: Whitening,
    settings: Settings,
    progress: Progress,
) -> tuple[Thresholds, Assessment]:
    """Thresholds of simulated rigs in order; those of noise where such rigs tell nothing.

    Over seconds of a lively machine commissioning errors bend a simulation by radians, and a fit
    cannot follow: rigs in order leave as much as a record with three faults. Such a record is not
    in order for that. It is judged by noise, and `Thresholds.in_order` says what they leave; it is
    None where rigs in order come to noise.
    """
    pull = pull_limit(bank, settings.alpha)

    def look(limits: Thresholds) -> Assessment:
        levels = (limits.effect, limits.misfit, pull, limits.bends, settings.sparse)
        return assess(measured, bank, whitening, *levels, progress=progress)

    limits = cached_thresholds(bank, whitening, settings, progress)
    first = look(limits)
    by_noise = noise_thresholds(bank, whitening, settings.alpha)
    if not first.astray or (limits.in_order or 0.0) < OUT_OF_STEP * by_noise.misfit:
        return replace(limits, in_order=None), first
    limits = replace(by_noise, in_order=limits.in_order)
    return limits, look(limits)
