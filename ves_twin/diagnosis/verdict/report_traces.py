"""ReportTraces: what a report of a diagnosis shows: traces and residuals, before and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ves_twin.core.read_only import ReadOnly
from ves_twin.core.types import FloatArray, IntArray, SingleArray
from ves_twin.diagnosis.bank.envelope import envelope_sd
from ves_twin.diagnosis.fit.assess import Assessment
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.refine import Fit, bare_residual
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.record.adequacy import EnergyCell, cells
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.whitening import Whitening


@dataclass(frozen=True)
class Traces(ReadOnly):
    """One recording on the analysis grid.

    Attributes:
        name: of the recording.
        time: of the rows [s] (n,).
        measured, nominal, fitted: channels in their units (n, c); nominal is the model as it is,
            fitted has commissioning errors and, where there is one, the best explanation.
        tolerances: channels with commissioning errors fitted as far as a machine in order may have
            them, and no cause (n, c); `fitted` where no cause is in it.
        reach: sd of what a machine in order shows about `nominal`, of noise and tolerances (n, c).
        sigma_time: of the whitened rows [s] (m,).
        before, after: residuals of nominal and fitted in noise sigma, whitened (m, c).
        without: residual of `tolerances`, likewise.

    NaN stands where a recording has a hole.
    """

    name: str
    time: FloatArray
    measured: SingleArray
    nominal: SingleArray
    fitted: SingleArray
    tolerances: SingleArray
    reach: SingleArray
    sigma_time: FloatArray
    before: FloatArray
    after: FloatArray
    without: FloatArray


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
    before: tuple[EnergyCell, ...]
    after: tuple[EnergyCell, ...]

    @property
    def telling(self) -> IntArray:
        """Channels by how much the cause changes them beyond what tolerances can (c,).

        Without a cause: by what the nominal model leaves.
        """
        pairs = [(t.without - t.after if self.causes else t.before) for t in self.traces]
        return np.argsort(-np.nansum(np.square(np.concatenate(pairs)), axis=0), kind="stable")


def exhibit_of(
    seen: Dataset, first: Assessment, found: Explanation | None, alone: Fit | None
) -> ReportTraces:
    """What the best explanation, or commissioning errors alone, make of the recordings.

    Args:
        seen: the recordings.
        first: the record before any cause.
        found: its explanation; None if none was needed, or none is there.
        alone: commissioning errors within their tolerances, without a cause; None: as fitted.
    """
    runs = seen.runs
    nominal = first.screen.bank.base.prediction
    whitening = found.evidence.whitening if found else first.evidence.whitening
    after, left = _left(seen, first, found)
    before = whitening.apply(seen.measured - nominal)
    fitted = seen.measured - left
    kept = whitening.freedom > 0.0
    untold = bare_residual(found.evidence, alone or found.commissioning) if found else left
    without = whitening.apply(untold) if found else after
    reach = envelope_sd(first.screen.bank.base)
    shown = [np.where(kept, z, np.nan) for z in (before, after, without)]
    blocks = zip(*(whitening.blocks(z) for z in shown), strict=True)
    measured = _with_holes(seen)
    traces = tuple(
        Traces(
            name=programme.name if len(runs.slices) == 1 else f"{programme.name} ({k + 1})",
            time=runs.times[k],
            measured=measured[rows],
            nominal=nominal[rows],
            fitted=fitted[rows],
            tolerances=(seen.measured - untold)[rows],
            reach=reach[rows],
            sigma_time=whitening.times()[k],
            before=there,
            after=here,
            without=bare,
        )
        for k, (programme, rows, (there, here, bare)) in enumerate(
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


def _cells(whitening: Whitening, z: FloatArray) -> tuple[EnergyCell, ...]:
    return tuple(cells(whitening, z))
