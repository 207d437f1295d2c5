"""ReportTraces: what a report of a diagnosis shows: traces and residuals, before and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.types import FloatArray, SingleArray
from ves_twin.diagnosis.adequacy import Cell, cells
from ves_twin.diagnosis.assess import Assessment
from ves_twin.diagnosis.explain import Explanation
from ves_twin.diagnosis.forward import Channel
from ves_twin.diagnosis.preprocess import Dataset
from ves_twin.diagnosis.refine import bare_residual
from ves_twin.diagnosis.whitening import Whitening


@dataclass(frozen=True)
class Traces:
    """One recording on the analysis grid.

    Attributes:
        name: of the recording.
        time: of the rows [s] (n,).
        measured, nominal, fitted: channels in their units (n, c); nominal is the model as it is,
            fitted has commissioning errors and, where there is one, the best explanation.
        sigma_time: of the whitened rows [s] (m,).
        before, after: residuals of the two models in noise sigma, whitened (m, c).

    NaN stands where a recording has a hole.
    """

    name: str
    time: FloatArray
    measured: SingleArray
    nominal: SingleArray
    fitted: SingleArray
    sigma_time: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True)
class ReportTraces:
    """All recordings of a diagnosis, and the maps of what each model leaves.

    Attributes:
        channels: what was compared (c).
        causes: labels of what the fitted model has beside commissioning errors.
        traces: one for each recording.
        before, after: cells of both residuals.
    """

    channels: tuple[Channel, ...]
    causes: tuple[str, ...]
    traces: tuple[Traces, ...]
    before: tuple[Cell, ...]
    after: tuple[Cell, ...]


def exhibit_of(seen: Dataset, first: Assessment, found: Explanation | None) -> ReportTraces:
    """What the best explanation, or commissioning errors alone, make of the recordings.

    Args:
        seen: the recordings.
        first: the record before any cause.
        found: its explanation; None if none was needed, or none is there.
    """
    runs = seen.runs
    nominal = first.screen.bank.base.prediction
    whitening = found.evidence.whitening if found else first.evidence.whitening
    after, bare = _left(seen, first, found)
    before = whitening.apply(seen.measured - nominal)
    fitted = seen.measured - bare
    kept = whitening.freedom > 0.0
    shown = [np.where(kept, z, np.nan) for z in (before, after)]
    blocks = zip(*(whitening.blocks(z) for z in shown), strict=True)
    measured = _with_holes(seen)
    traces = tuple(
        Traces(
            name=programme.name if len(runs.slices) == 1 else f"{programme.name} ({k + 1})",
            time=runs.times[k],
            measured=measured[rows],
            nominal=nominal[rows],
            fitted=fitted[rows],
            sigma_time=whitening.times()[k],
            before=there,
            after=here,
        )
        for k, (programme, rows, (there, here)) in enumerate(
            zip(runs.programmes, runs.slices, blocks, strict=True)
        )
    )
    return ReportTraces(
        channels=tuple(runs.forward.channels[c] for c in runs.columns),
        causes=tuple(h.label for h in found.best.causes) if found else (),
        traces=traces,
        before=_cells(whitening, before),
        after=_cells(whitening, after),
    )


def _with_holes(seen: Dataset) -> SingleArray:
    if not seen.runs.holes:
        return seen.measured
    return np.where(np.concatenate(seen.runs.holes), np.float32(np.nan), seen.measured)


def _left(
    seen: Dataset, first: Assessment, found: Explanation | None
) -> tuple[FloatArray, SingleArray]:
    """Residual of the fitted model: whitened (samples,), and in the channels' units (rows, c)."""
    if found:
        return found.best.residual, bare_residual(found.evidence, found.best)
    if first.commissioning:
        return first.commissioning.residual, bare_residual(first.evidence, first.commissioning)
    base = first.screen.bank.base
    errors = first.screen.metric.nuisances(first.z).astype(np.float32)
    change = np.tensordot(errors, base.columns, axes=1)
    return first.left, seen.measured - base.prediction - change


def _cells(whitening: Whitening, z: FloatArray) -> tuple[Cell, ...]:
    return tuple(cells(whitening, z))
