"""diagnose: from recordings to a verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ves_twin.core.budget import Budget
from ves_twin.core.errors import UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.fit.tolerances import cached_scale, check_commissioned
from ves_twin.diagnosis.judge_view import judge_view
from ves_twin.diagnosis.model.forward import Excitation, Forward
from ves_twin.diagnosis.model.widened import Widened, widening
from ves_twin.diagnosis.record.preprocess import check_lengths, preprocess
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.both_views import both_views, is_firm
from ves_twin.diagnosis.verdict.verdict import Kind, Verdict
from ves_twin.diagnosis.view import Material, View


def diagnose(
    forward: Forward,
    recordings: Sequence[Recording],
    *,
    held_out: Sequence[Recording] = (),
    commissioning: Sequence[Recording] = (),
    standstill: Recording | None = None,
    baseline: Sequence[Recording] = (),
    next_programmes: Sequence[Excitation] | Callable[[], Sequence[Excitation]] = (),
    exclude: Sequence[str] = (),
    settings: Settings | None = None,
    progress: Progress = silent,
    budget: Budget | None = None,
) -> Verdict:
    """Name what a plant's simulation gets wrong, or say that nothing is, or that it is not known.

    Residuals in units of noise, with commissioning tolerances marginalised; a bank of finite
    signatures ranks the causes, the full forward fits the best of them, what is left must be noise.

    Args:
        forward: the plant, its tolerances and its library of causes.
        recordings: what was measured; all of them together are one record.
        held_out: other recordings, on which the gain of an extension is measured.
        commissioning: of independent rigs in order, or of re-mountings of this one; five or more
            tell how true the declared tolerances are.
        standstill: tells the noise; the declared one is taken without it.
        baseline: of this rig in order, of the same programmes: what the model always gets wrong
            on it is taken off, so that only what has changed since is named.
        next_programmes: candidates for the next experiment where causes cannot be told apart; or
            what makes them, called only then.
        exclude: causes that are not considered, by effect or effect@target.
        settings: how sure, how many.
        progress: told what is being done.
        budget: time that it may take, which may be ended; that of the settings if left out.

    Raises:
        InvalidInputError: recordings that cannot be compared, columns that look swapped, turned
            or in other units, or too few rigs in order to tell the tolerances.
        UnknownNameError: a signal that is not recorded, or an unknown cause in `exclude`.
    """
    chosen = settings or Settings()
    _check_causes(forward, exclude)
    check_commissioned(len(commissioning))
    check_lengths(forward, held_out, chosen.rate)
    with Workers(chosen.workers, budget or chosen.budget) as workers:
        scale = _scale(forward, commissioning, workers, chosen)
        material = Material(
            tuple(recordings),
            tuple(held_out),
            standstill,
            tuple(baseline),
            next_programmes,
            tuple(exclude),
            scale,
        )
        declared = View.of(forward, material, chosen, workers, progress)
        wide = widening(scale)
        if wide == 1.0 or not declared.loud:
            return judge_view(declared, progress)
        widened = Widened(forward, wide)
        measured = judge_view(View.of(widened, material, chosen, workers, progress, wide), progress)
        if is_firm(measured):
            return measured
        in_order = measured.verdict is Kind.NOTHING
        return both_views(judge_view(declared, progress, alone=in_order), measured)


def _check_causes(forward: Forward, names: Sequence[str]) -> None:
    known = {h.effect for h in forward.hypotheses} | {h.label for h in forward.hypotheses}
    for name in names:
        if name not in known:
            raise UnknownNameError("cause", name, known)


def _scale(
    forward: Forward, commissioning: Sequence[Recording], workers: Workers, chosen: Settings
) -> float | None:
    if not commissioning:
        return None
    rigs = [preprocess(forward, [recording], workers, chosen.rate) for recording in commissioning]
    return cached_scale([(rig.runs, rig.measured) for rig in rigs], chosen.cache)
