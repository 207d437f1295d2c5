"""explain: fit the suspects with the full forward, one alone or two together, and judge them."""

from __future__ import annotations

from dataclasses import replace

from ves_twin.diagnosis.bank.screen import Candidate
from ves_twin.diagnosis.explain.judge import judge
from ves_twin.diagnosis.explain.pairs import pairs, strained_pair
from ves_twin.diagnosis.fit.assess import STRANGE, Assessment, pull_limit
from ves_twin.diagnosis.fit.explanation import Explanation
from ves_twin.diagnosis.fit.fit_context import FitContext
from ves_twin.diagnosis.fit.fits import CLOSE, is_near, settled, tried
from ves_twin.diagnosis.fit.null import Thresholds
from ves_twin.diagnosis.fit.refine import Fit
from ves_twin.diagnosis.record.adequacy import cells, misfit
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings

FAR = 0.5
"""Share of the likeliest suspect's score that another must have to be fitted at once."""

TOGETHER = 2
"""Causes that are looked for together here."""

MANY = 100.0
"""Chi^2 a sample from which what the best of single causes leaves is taken for more of them: ten
times the noise. Weighed in full first, single causes took a quarter of a satellite's time."""

HOPE = 0.5
"""Share of what is there that a cause, or a pair by the screen, must take to be gone on with."""


def explain(
    first: Assessment,
    thresholds: Thresholds,
    settings: Settings,
    progress: Progress = silent,
    together: bool = True,
    glance: bool = False,
) -> Explanation | None:
    """Single causes, then pairs where no single one leaves noise.

    Args:
        first: the record before any cause, over a threshold.
        thresholds: what noise and commissioning errors do.
        settings: how many and how much.
        progress: told how far it is.
        together: whether two causes are tried, too.
        glance: whether first fits will do where the best of them leaves MANY times the noise.

    Returns:
        The best explanation, adequate or not; None if the library is empty or fits nothing.
    """
    desk = FitContext(first, thresholds, settings, progress)
    found = _singles(desk, together, glance)
    if found is None or found.adequate or found.far or found.rough or not together:
        return found
    if first.evidence.runs.budget.skips("pairs of causes"):
        return found
    return pairs(desk, found) or found


def _singles(desk: FitContext, together: bool, glance: bool) -> Explanation | None:
    """Suspects near the likeliest, two at least; all, where none of those leaves noise.

    Two, so that the page has a rival to show. Where runs are dear one does that was fitted with the
    commissioning errors, the pair that the likeliest asks for comes first, and columns are
    computed at the fit only where a verdict hangs on them.
    """
    suspects = desk.first.suspects[: desk.settings.candidates]
    if not suspects:
        return None
    reach = suspects[0].score - max(FAR * suspects[0].score, CLOSE)
    least = 1 if desk.settings.sparse and _fitted_already(desk, suspects[0]) else 2
    near = [one for n, one in enumerate(suspects) if n < least or one.score >= reach]
    rest, fits = suspects[len(near) :], tried(desk, near)
    double = strained_pair(desk, fits) if together and desk.settings.sparse else None
    if double is not None:
        return double
    if rest and _far(desk, fits):
        fits, rest = [*fits, *tried(desk, rest)], []
    if _far(desk, fits):
        found = replace(judge(desk, fits, far=True), far=True)
    elif glance and (best := min(fits, key=_chi2)).chi2 > MANY * len(best.residual):
        found = replace(judge(desk, fits, far=True), rough=True)
    else:
        fits, found = _weighed(desk, fits)
        others = tried(desk, rest) if rest and not found.adequate else []
        fits = [*fits, *others]
        if any(is_near(fit, min(fits, key=_chi2)) for fit in others):
            fits, found = _weighed(desk, fits)
    judged = {fit.causes for fit in found.fits}
    return replace(found, hopeless=tuple(fit for fit in fits if fit.causes not in judged))


def _weighed(desk: FitContext, fits: list[Fit]) -> tuple[list[Fit], Explanation]:
    """Judged by columns at the leader's fit; as they are where runs are dear and that will do."""
    if desk.settings.sparse and _clear(desk, fits):
        found = judge(desk, fits)
        if found.adequate:
            return fits, found
    fits = settled(desk.first.evidence, fits, desk)
    return fits, judge(desk, fits)


def _fitted_already(desk: FitContext, suspect: Candidate) -> bool:
    """Whether a suspect was fitted with the commissioning errors, and left noise."""
    first = desk.first
    cause = first.screen.bank.hypotheses[suspect.hypothesis]
    return first.beside is not None and first.beside.causes == (cause,)


def _clear(desk: FitContext, fits: list[Fit]) -> bool:
    """Whether one fit leaves noise without a strained commissioning error, and none comes near."""
    leader = min(fits, key=_chi2)
    left = misfit(cells(desk.first.evidence.whitening, leader.residual))
    limit = pull_limit(desk.first.screen.bank, desk.settings.alpha)
    rivals = sum(is_near(fit, leader) for fit in fits) - 1
    return rivals == 0 and left < desk.thresholds.misfit and leader.pull <= limit


def _chi2(fit: Fit) -> float:
    return fit.chi2


def _far(desk: FitContext, fits: list[Fit]) -> bool:
    """Whether what causes take is so little that neither new columns nor a second one would do.

    Of a machine of many parameters alone: of others runs are cheap, and laws may be looked for.
    """
    first, best = desk.first, min(fits, key=lambda fit: fit.chi2)
    if not desk.settings.sparse or desk.settings.causes > TOGETHER or first.commissioning is None:
        return False
    noise = len(best.residual)
    there = first.commissioning.chi2 - noise
    if best.chi2 - noise < (1.0 - HOPE) * there or best.chi2 < STRANGE * noise:
        return False
    power = float(first.z @ first.left)
    return all(one.score < HOPE * power for one, _ in first.screen.pairs(first.z, 1))
