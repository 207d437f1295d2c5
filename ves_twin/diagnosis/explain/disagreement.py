"""disagreement: what each recording says alone, where all of them together have no explanation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ves_twin.diagnosis.bank.signature_library import SignatureLibrary
from ves_twin.diagnosis.bank.slices import of_recording
from ves_twin.diagnosis.explain.explain import explain
from ves_twin.diagnosis.fit.assess import assess, pull_limit
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.record.whitening import Whitening
from ves_twin.diagnosis.settings import Settings


@dataclass(frozen=True)
class Alone:
    """What one recording says by itself.

    Attributes:
        recording: its name.
        explained: whether nothing is wrong in it, or one cause explains it.
        causes: labels of that cause and of its equals; empty for nothing.
        sizes: fitted departures of the first of them, with units.
    """

    recording: str
    explained: bool
    causes: tuple[str, ...]
    sizes: tuple[tuple[float, str], ...]


def disagreement(
    seen: Dataset,
    bank: SignatureLibrary,
    whitening: Whitening,
    limits: Thresholds,
    settings: Settings,
    progress: Progress = silent,
) -> tuple[Alone, ...]:
    """Every recording judged alone, by the thresholds of all together and by single causes.

    Args:
        seen: two or more recordings.
        bank: of all of them, at nominal.
        whitening: as declared or measured.
        limits: what noise and commissioning errors do.
        settings: how many causes are fitted.
        progress: told how far it is.

    Returns:
        One answer for each recording; none for a single recording.
    """
    runs = seen.runs
    if len(runs.programmes) < 2:
        return ()
    found = []
    for k, programme in enumerate(runs.programmes):
        if runs.budget.skips("what each recording says alone"):
            return ()
        part = of_recording(bank, k)
        own = replace(
            whitening,
            runs=part.base.runs,
            filters=whitening.filters[k : k + 1],
            mixing=whitening.mixing[k : k + 1],
            colour=whitening.colour[k : k + 1],
            level=whitening.level[k : k + 1],
        )
        rows = seen.measured[runs.slices[k]]
        pull = pull_limit(part, settings.alpha)
        first = assess(rows, part, own, limits.effect, limits.misfit, pull, limits.bends)
        name = f"{programme.name} ({k + 1})"
        if not first.exceeds(limits.effect, limits.misfit, pull):
            found.append(Alone(name, True, (), ()))
            continue
        best = explain(first, limits, settings, progress, together=False)
        if best is None:
            found.append(Alone(name, False, (), ()))
            continue
        free = best.best.active[: len(best.best.sizes)]
        units = [part.base.runs.coordinates[int(i)].parameter.unit for i in free]
        causes = tuple(h.label for fit in best.chosen for h in fit.causes)
        sizes = tuple((float(s), u) for s, u in zip(best.best.sizes, units, strict=True))
        found.append(Alone(name, bool(best.adequate), causes, sizes))
    return tuple(found)


def disagree(said: Sequence[Alone]) -> bool:
    """Whether each recording is explained alone, though all together are not."""
    return len(said) > 1 and all(one.explained for one in said)
