"""trend: recordings of one machine on different days to what changed, and since when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import norm

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.fit.tolerances import naming_limit
from ves_twin.diagnosis.model.forward import Forward
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend.calendar import Calendar
from ves_twin.diagnosis.trend.change import Change, Course, change_of
from ves_twin.diagnosis.trend.follow import Followed, follow
from ves_twin.diagnosis.trend.one_rig import OneRig, one_rig
from ves_twin.diagnosis.trend.result import Answer, DaySize, FollowedCause, Trend
from ves_twin.diagnosis.trend.series import Series
from ves_twin.diagnosis.trend.study import Study
from ves_twin.diagnosis.verdict.verdict import Basis

ALPHA = 0.01
"""Rate of false alarms for a whole series, where nobody states another."""

FEWEST_DAYS = 5
"""Days from which one may be imperfect: four tell a step by themselves."""

FEWEST = 3
"""Recordings of a series."""


def trend(
    forward: Forward,
    recordings: Sequence[Recording],
    calendar: Calendar,
    *,
    standstill: Recording | None = None,
    exclude: Sequence[str] = (),
    cause: str = "",
    false_alarm: float = ALPHA,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Trend:
    """Name a cause, follow its size from day to day, and say whether, when and how it changed.

    Every recording has its own noise, start and zero errors; the machine's commissioning errors
    are one for all. Screened are, over the whole library, a constant size and every step and ramp;
    the best suspects are fitted in each recording by the full forward.

    Args:
        forward: the plant, its tolerances and its library of causes.
        recordings: one or more of each day, of one machine.
        calendar: date of each.
        standstill: tells the noise; the declared one is taken without it.
        exclude: causes that are not considered, by effect or effect@target.
        cause: effect@target to follow without asking which; the limit is then that of it alone.
        false_alarm: probability that a machine on which nothing changed is said to have changed.
        settings: how sure, how many; `alpha` is not used.
        progress: told what is being done.

    Raises:
        InvalidInputError: fewer than three recordings, one date for all, or a rate out of range.
        UnknownNameError: an unknown cause, or a signal that is not recorded.
    """
    _check(forward, recordings, calendar.days, [*exclude, *([cause] if cause else [])], false_alarm)
    chosen = replace(settings or Settings(), alpha=false_alarm, simulated_nulls=False)
    order = np.argsort(np.asarray(calendar.days), kind="stable")
    with Workers(chosen.workers) as workers:
        study = Study(forward, chosen, standstill, tuple(exclude), cause, workers, progress)
        causes = study.causes
        seen = [
            study.day(recordings[i], calendar.days[i], n, len(order)) for n, i in enumerate(order)
        ]
        series = Series.of(seen, causes, chosen)
        return _answer(series, study, calendar)


def _check(
    forward: Forward,
    recordings: Sequence[Recording],
    days: Sequence[float],
    causes: Sequence[str],
    false_alarm: float,
) -> None:
    if len(recordings) < FEWEST:
        raise InvalidInputError("recordings of a trend", len(recordings), f"at least {FEWEST}")
    if len(days) != len(recordings) or not np.all(np.isfinite(days)):
        raise InvalidInputError("days", list(days), "one for each recording")
    if len(set(days)) < 2:
        raise InvalidInputError("dates of the recordings", "one for all", "two or more")
    if not 1e-4 <= false_alarm <= 0.2:
        raise InvalidInputError("rate of false alarms", false_alarm, "0.0001 to 0.2")
    known = {h.effect for h in forward.hypotheses} | {h.label for h in forward.hypotheses}
    for name in causes:
        if name not in known:
            raise UnknownNameError("cause", name, known)


def _answer(series: Series, study: Study, calendar: Calendar) -> Trend:
    settings, days = study.settings, series.days
    basis = Basis("declared" if study.standstill is None else "measured", "declared", "none")
    bare = Trend(
        answer=Answer.NOTHING if series.rig.agrees else Answer.MIXED,
        false_alarm=settings.alpha,
        basis=basis,
        statistics=series.statistics,
        one_rig=series.rig,
        recordings=tuple(day.name for day in days),
        calendar=calendar,
        smallest_change=series.smallest(),
        not_followed=tuple(h.label for h in days[0].bank.hypotheses if h not in series.causes),
        excluded=study.exclude,
    )
    if not series.suspicious:
        return bare
    followed: list[Followed] = []
    suspects = series.suspects(settings.candidates)
    for n, cause in enumerate(suspects):
        study.progress(n / len(suspects), f"following {cause.label}")
        followed.append(follow(days, cause, study.workers, settings.rounds, settings.model_error))
    followed.sort(key=lambda one: one.chi2)
    told = _concluded(bare, series, followed, settings)
    if len(told.unexplained) == 1 and len(days) >= FEWEST_DAYS:
        return _without(told, series, study)
    return told


def _without(told: Trend, series: Series, study: Study) -> Trend:
    """The course over all other days, where one is imperfect; its name is then not firm.

    That day pulls the commissioning errors that all days share, and so the others' sizes.
    """
    others = [day for day in series.days if day.name not in told.unexplained]
    rest = _answer(Series.of(others, study.causes, study.settings), study, told.calendar)
    if rest.answer not in (Answer.STEP, Answer.RAMP) or rest.cause is None:
        return told
    cause = replace(rest.cause, firm=False)
    return replace(rest, cause=cause, recordings=told.recordings, unexplained=told.unexplained)


def _concluded(
    bare: Trend, series: Series, followed: Sequence[Followed], settings: Settings
) -> Trend:
    """The best cause: whether it explains all days of one rig, and how its size went."""
    best, days = followed[0], series.days
    change = change_of(
        np.array([day.time for day in days]),
        series.parameter(best.cause).nominal + best.sizes,
        best.covariance,
        series.limits,
        settings.confidence,
        settings.seed,
    )
    parts = [fit.sharing for fit in best.days]
    rig = one_rig(parts, best.days[0].shared, settings.alpha, settings.seed)
    sizes = _sizes(best, series, bare.calendar, settings)
    left = tuple(size.recording for size in sizes if not size.explained)
    answer = _kind(best, change, rig, left, series)
    cause = _cause(followed, change, series, settings)
    own = series.parameter(best.cause).sd > 0.0 and not series.rig.agrees
    if answer is Answer.MIXED and own:
        rig = series.rig  # with the followed parameter among those that differ
    told = replace(bare, one_rig=rig, cause=cause, sizes=sizes, change=change, unexplained=left)
    if answer is Answer.NOTHING:
        return replace(bare, answer=answer, one_rig=rig)
    return replace(told, answer=answer)


def _kind(
    best: Followed, change: Change, rig: OneRig, left: Sequence[str], series: Series
) -> Answer:
    if left:
        return Answer.UNKNOWN
    if not rig.agrees:
        return Answer.MIXED
    if change.course is not Course.CONSTANT:
        return Answer(change.course.value)
    return Answer.CONSTANT if _lasting(best, series) > series.limits.constant else Answer.NOTHING


def _lasting(best: Followed, series: Series) -> float:
    """chi^2 of a constant size, its own commissioning error no fault."""
    sd = series.parameter(best.cause).sd
    power = np.linalg.inv(best.covariance + sd**2 * np.ones_like(best.covariance))
    along = float(np.sum(power @ best.sizes))
    wrong = along < 0.0 and -1 not in best.cause.signs
    return 0.0 if wrong else along**2 / float(np.sum(power))


def _sizes(
    best: Followed, series: Series, calendar: Calendar, settings: Settings
) -> tuple[DaySize, ...]:
    nominal = series.parameter(best.cause).nominal
    reach = float(norm.isf(0.5 * (1.0 - settings.confidence)))
    against = _against(best.covariance)
    found = []
    for k, (day, fit) in enumerate(zip(series.days, best.days, strict=True)):
        value, sd = nominal + float(best.sizes[k]), float(np.sqrt(best.covariance[k, k]))
        found.append(
            DaySize(
                recording=day.name,
                date=calendar.words(day.time),
                day=day.time,
                value=value,
                low=value - reach * sd,
                high=value + reach * sd,
                sd=float(against[k]),
                left=fit.score,
                explained=fit.score < day.limits.misfit,
            )
        )
    return tuple(found)


def _against(covariance: FloatArray) -> FloatArray:
    """Sd (n,) of each size without the common part, of which the mean is taken as free."""
    power, one = np.linalg.inv(covariance), np.ones(len(covariance))
    base = power @ one
    left = power - np.outer(base, base) / float(one @ base)
    return np.asarray(1.0 / np.sqrt(np.maximum(np.diag(left), 1e-300)))


def _cause(
    followed: Sequence[Followed], change: Change, series: Series, settings: Settings
) -> FollowedCause:
    best = followed[0]
    parameter = series.parameter(best.cause)
    behind = {one.cause.label: one.chi2 - best.chi2 for one in followed[1:]}
    explained = sum(fit.plain - fit.chi2 for fit in best.days)
    near = 2.0 * np.log(settings.odds) + settings.model_error**2 * max(explained, 0.0)
    changed = change.course in (Course.STEP, Course.RAMP)
    lasting = abs(change.before.value - parameter.nominal) if change.before else 0.0
    sigmas = lasting / parameter.sd if parameter.sd > 0.0 else None
    limit = naming_limit(series.days[0].bank, None)
    return FollowedCause(
        effect=best.cause.effect,
        target=best.cause.target,
        parameter=parameter.name,
        unit=parameter.unit,
        nominal=parameter.nominal,
        firm=changed or sigmas is None or sigmas >= limit,
        sigmas=sigmas,
        rivals=behind,
        equals=tuple(label for label, more in behind.items() if more < near),
    )
