"""Trends on the linear plant: shapes, onsets, rates of false alarms, machines that were mixed."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest
from scipy.stats import binom
from toy import NUISANCES, SERIES_DAYS, Toy, programme, record

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.diagnosis.bank.metric import Metric
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend import trend as trend_module
from ves_twin.diagnosis.trend.calendar import Calendar
from ves_twin.diagnosis.trend.change import Course, change_of
from ves_twin.diagnosis.trend.day import Telling
from ves_twin.diagnosis.trend.false_alarms import false_alarm_limits, scores
from ves_twin.diagnosis.trend.joint import Joint
from ves_twin.diagnosis.trend.one_rig import Sharing, one_rig
from ves_twin.diagnosis.trend.result import Answer
from ves_twin.diagnosis.trend.series import Series
from ves_twin.diagnosis.trend.shapes import Shapes
from ves_twin.diagnosis.trend.study import Study
from ves_twin.diagnosis.trend.trend import trend
from ves_twin.report.diagnosis.trend_page import trend_page
from ves_twin.report.diagnosis.trend_words import trend_headline

DAYS = np.array([0.0, 3.0, 4.0, 7.0, 10.0, 11.0, 14.0, 17.0, 20.0, 21.0])
SURE = 1e-4
"""Probability that a right programme fails a bound on a count."""

TRUE = Toy().hypotheses[1]


def covariance(rng):
    """Own errors of different sizes, and one that all days share."""
    return np.diag(rng.uniform(0.5, 1.5, len(DAYS)) ** 2) + 4.0


def limits_of(spread, alpha):
    """Of a single cause with sizes of a covariance."""
    n = len(spread)
    joint = Joint(np.zeros((1, n)), np.linalg.inv(spread).reshape(1, n, 1, n))
    return false_alarm_limits(joint, Shapes(DAYS), [TRUE], alpha)


def courses(count, alpha, make, seed=0):
    rng = np.random.default_rng(seed)
    spread = covariance(rng)
    limits, root = limits_of(spread, alpha), np.linalg.cholesky(spread)
    for _ in range(count):
        sizes = make(rng) + root @ rng.standard_normal(len(DAYS))
        yield change_of(DAYS, sizes, spread, limits)


def test_a_constant_size_is_called_changed_as_often_as_stated():
    alpha, count = 0.05, 2000
    found = [c.course for c in courses(count, alpha, lambda rng: np.full(len(DAYS), 3.0))]
    changed = sum(course is not Course.CONSTANT for course in found)
    # the two halves of the rate overlap, so that it may be less than stated by that much
    assert changed <= binom.isf(SURE, count, alpha)
    assert changed >= binom.ppf(SURE, count, 0.5 * alpha)


def test_sizes_that_scatter_from_day_to_day_are_no_trend():
    alpha, count = 0.05, 200
    found = list(courses(count, alpha, lambda rng: 8.0 * rng.standard_normal(len(DAYS))))
    claimed = sum(c.course in (Course.STEP, Course.RAMP) for c in found)
    assert claimed <= binom.isf(SURE, count, alpha)
    varies = [c for c in found if c.course is Course.VARIES]
    assert len(varies) > 0.9 * (count - claimed)
    assert np.median([c.scatter for c in varies]) == pytest.approx(8.0, rel=0.15)


def test_a_step_is_found_through_scatter_that_its_intervals_do_not_have():
    def make(rng):
        return 3.0 * rng.standard_normal(len(DAYS)) + 25.0 * (DAYS >= 11.0)

    found = list(courses(40, 0.05, make))
    right = sum(c.course is Course.STEP and c.onset.value == 11.0 for c in found)
    assert right >= 32
    assert all(c.permutation is not None for c in found if c.scatter > 0.0)


@pytest.mark.parametrize(
    ("course", "make", "onset"),
    [
        (Course.STEP, lambda d: 4.0 * (d >= 11.0), 10.5),
        (Course.RAMP, lambda d: 0.8 * np.maximum(d - 8.5, 0.0), 8.5),
    ],
)
def test_intervals_of_onset_and_size_hold_the_truth_nine_times_of_ten(course, make, onset):
    found = [c for c in courses(400, 0.01, lambda rng: make(DAYS)) if c.course is course]
    assert len(found) > 250  # of a step of 4 sd a quarter look like ramps, and say so
    held = sum(c.onset.low <= onset <= c.onset.high for c in found)
    assert held >= binom.ppf(SURE, len(found), 0.9)
    if course is Course.RAMP:
        slopes = sum(c.slope.low <= 0.8 <= c.slope.high for c in found)
        assert slopes >= binom.ppf(SURE, len(found), 0.9)


def test_scores_are_those_of_all_recordings_in_one_matrix():
    """S'(I + N N')^-1 z with shared and own columns in N, against sums day by day."""
    rng = np.random.default_rng(1)
    n, rows, p, q, h = 4, 60, 3, 2, 2
    shared, own, marks = (rng.standard_normal((n, rows, k)) for k in (p, q, h))
    z = rng.standard_normal((n, rows))
    columns = np.zeros((n * rows, p + n * q))
    signs = np.zeros((n * rows, h, n))
    told = []
    for k in range(n):
        at = slice(k * rows, (k + 1) * rows)
        columns[at, :p], columns[at, p + k * q : p + (k + 1) * q] = shared[k], own[k]
        signs[at, :, k] = marks[k]
        both = np.concatenate([shared[k], marks[k]], axis=1)
        kept = Metric(own[k]).project(both)
        told.append(Telling(both.T @ kept, kept.T @ z[k], p))
    whole = np.linalg.inv(np.eye(n * rows) + columns @ columns.T)
    flat = signs.reshape(n * rows, h * n)
    joint = Joint.of(told)
    assert joint.score.ravel() == pytest.approx(flat.T @ whole @ z.ravel(), abs=1e-9)
    assert joint.gram.reshape(h * n, h * n) == pytest.approx(flat.T @ whole @ flat, abs=1e-9)


def sharing(rng, truths):
    days = []
    for truth in truths:
        columns = rng.standard_normal((40, len(truth))) * [3.0, 1.0, 0.2]
        z = columns @ truth + rng.standard_normal(40)
        days.append(Sharing(columns.T @ columns, columns.T @ z))
    return days


def test_one_machine_is_taken_for_several_as_often_as_stated():
    alpha, count, names = 0.10, 200, ("a", "b", "c")
    rng, apart = np.random.default_rng(3), 0
    for _ in range(count):
        truth = rng.standard_normal(3)
        apart += not one_rig(sharing(rng, [truth] * 5), names, alpha).agrees
    assert binom.ppf(SURE, count, alpha) <= apart <= binom.isf(SURE, count, alpha)


def test_two_machines_are_told_apart_and_grouped():
    rng = np.random.default_rng(4)
    one, two = np.array([0.0, 0.3, 0.1]), np.array([1.5, 0.3, 0.1])
    found = one_rig(sharing(rng, [one, two, one, one, two]), ("a", "b", "c"), 0.01)
    assert not found.agrees
    assert found.differs[0].parameter == "a"
    assert found.groups == ((0, 2, 3), (1, 4))
    assert found.differs[0].sds[1] - found.differs[0].sds[0] == pytest.approx(1.5, abs=0.3)


@pytest.fixture(scope="module")
def settings(banks):
    return Settings(nulls=60, cache=banks, candidates=3)


def machine(rng):
    return {p.name: p.sd * rng.standard_normal() for p in NUISANCES if not p.per_recording}


def series(seed, sizes, name="friction", other=(), added=None):
    """Recordings of one machine, those of `other` of a second one, each day with its own start."""
    rng = np.random.default_rng(seed)
    one, two = machine(rng), machine(rng)
    out = []
    for k, size in enumerate(sizes):
        value = dict(two if k in other else one)
        value["plant.offset"] = 0.05 * rng.standard_normal()
        key = "plant.gain" if name == "gain" else f"{name}.size"
        value[key] = value.get(key, 0.0) + size
        extra = None if added is None else added[k]
        out.append(record(rng, value, spread=0.0, fed=programme(1), added=extra))
    return out


def dated(count):
    days = SERIES_DAYS[:count]
    return Calendar(datetime(2026, 3, 2), tuple(float(d) for d in days))


def followed(settings, sizes, seed=5, **options):
    told = {k: options.pop(k) for k in ("name", "other", "added") if k in options}
    recordings = series(seed, sizes, **told)
    return trend(Toy(), recordings, dated(len(sizes)), settings=settings, **options)


def test_a_step_is_named_dated_and_sized(settings):
    found = followed(settings, [0, 0, 0, 0, 0.02, 0.02])
    assert (found.answer, found.cause.label) == (Answer.STEP, "friction@plant")
    assert not found.cause.equals
    assert (found.change.onset.low, found.change.onset.value) == (10.0, 14.0)
    assert found.change.before.low <= 0.0 <= found.change.before.high
    assert found.change.after.value == pytest.approx(0.02, abs=0.002)  # sd 0.0007 a day
    assert found.one_rig.agrees
    said = trend_headline(found)
    assert "friction at plant changed between 2026-03-12 and 2026-03-16" in said
    content = json.loads(found.to_json())
    assert content["change"]["onset_date"]["value"] == "2026-03-16"
    assert len(content["sizes"]) == 6
    page = trend_page(found, "Trend of <six>")
    assert "Trend of &lt;six&gt;" in page
    assert said in page


@pytest.mark.slow
def test_a_ramp_has_an_onset_and_a_slope(settings):
    days = SERIES_DAYS[:8]
    found = followed(settings, [0.002 * max(d - 5.0, 0.0) for d in days])
    assert (found.answer, found.cause.label) == (Answer.RAMP, "friction@plant")
    assert found.change.onset.low <= 5.0 <= found.change.onset.high
    assert found.change.slope.low <= 0.002 <= found.change.slope.high
    assert "changes steadily since" in trend_headline(found)


@pytest.mark.slow
def test_a_cause_that_was_always_there_is_constant_and_nothing_is_nothing(settings):
    found = followed(settings, [0.02] * 6)
    assert (found.answer, found.cause.label) == (Answer.CONSTANT, "friction@plant")
    assert "constant since the first day" in trend_headline(found)
    assert followed(settings, [0.0] * 6).answer is Answer.NOTHING


@pytest.mark.slow
def test_a_change_within_the_tolerance_of_commissioning_is_seen_since_days_share_it(settings):
    """Half a declared sd of gain: no single recording can show it, and none is called faulty."""
    found = followed(settings, [0, 0, 0, 0.01, 0.01, 0.01], name="gain")
    assert (found.answer, found.cause.label) == (Answer.STEP, "gain@plant")
    change = found.change
    assert change.after.value - change.before.value == pytest.approx(0.01, abs=0.002)
    assert found.cause.firm


@pytest.mark.slow
def test_nothing_beside_the_followed_cause_is_said_even_where_the_screen_saw_two_machines(
    settings, monkeypatch
):
    """What the screen laid to several machines, the fits may lay to noise: they are finer."""
    monkeypatch.setattr(trend_module, "_kind", lambda *_: Answer.NOTHING)
    found = followed(settings, [0.0] * 6, other=(1, 4), seed=8)
    assert found.answer is Answer.NOTHING


@pytest.mark.slow
def test_recordings_of_two_machines_are_called_so_and_parted(settings):
    found = followed(settings, [0.0] * 6, other=(1, 4), seed=8)
    assert found.answer is Answer.MIXED
    assert found.one_rig.groups == ((0, 2, 3, 5), (1, 4))
    assert "not of one machine" in trend_headline(found)
    assert "What differs between recordings" in trend_page(found)


@pytest.mark.slow
def test_a_day_with_what_the_library_lacks_is_named_unexplained(settings):
    u = programme().drive["drive.u"][:, 0]
    cube = (u**3)[:, None] * [0.002, 0.0]
    found = followed(settings, [0.0] * 6, added=[None] * 4 + [cube] * 2)
    assert found.answer is Answer.UNKNOWN
    assert len(found.unexplained) == 2
    assert found.unexplained == found.recordings[4:]


@pytest.mark.slow
def test_one_imperfect_day_hides_no_step_and_takes_the_firm_name_away(settings):
    u = programme().drive["drive.u"][:, 0]
    cube = (u**3)[:, None] * [0.002, 0.0]
    sizes = [0.0, 0.0, 0.0, 0.02, 0.02, 0.02]
    found = followed(settings, sizes, added=[None, cube, *[None] * 4])
    assert (found.answer, found.cause.label) == (Answer.STEP, "friction@plant")
    assert found.unexplained == (found.recordings[1],)
    assert not found.cause.firm
    assert (found.change.onset.low, found.change.onset.value) == (7.0, 10.0)
    assert f"In {found.recordings[1]} something more is wrong" in trend_headline(found)


@pytest.mark.slow
def test_unchanged_machines_are_called_changed_as_often_as_stated(settings, cases):
    """From recordings to answer, at a rate of 10 % so that there is something to count."""
    alpha, count = 0.10, cases(300)
    answers = [
        followed(settings, [0.0] * 4, seed=s, false_alarm=alpha).answer for s in range(count)
    ]
    changed = sum(a in (Answer.STEP, Answer.RAMP, Answer.VARIES) for a in answers)
    assert changed <= binom.isf(SURE, count, alpha)
    for answer in (Answer.CONSTANT, Answer.MIXED, Answer.UNKNOWN):
        assert answers.count(answer) <= binom.isf(SURE, count, alpha), answer
    assert any(answer is not Answer.NOTHING for answer in answers)  # the bound is not an empty one


@pytest.mark.slow
def test_the_smallest_change_is_found_seven_times_of_ten(settings):
    study = Study(Toy(), replace(settings, alpha=0.01, simulated_nulls=False), None)
    recordings = series(3, [0.0] * 6)
    days = [study.day(r, float(SERIES_DAYS[k]), k, 6) for k, r in enumerate(recordings)]
    found = Series.of(days, study.causes, study.settings)
    middle = found.shapes.columns[(len(found.shapes.steps) - 1) // 2]
    drawn = found.joint.draws(np.random.default_rng(0), 1000)
    for h, cause in enumerate(found.causes):
        size = found.smallest()[cause.label].value
        mean = np.einsum("cnm,m->cn", found.joint.gram[:, :, h, :], size * middle)
        change = scores(found.joint, found.shapes, found.causes, drawn + mean).change.max(axis=1)
        seen = np.mean(change > found.limits.change)
        # a neighbouring date or another cause may pass instead, so that it is rather more
        assert 0.65 < seen < 0.80, cause.label


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"count": 2}, "at least 3"),
        ({"cause": "fricton@plant"}, "did you mean 'friction@plant'"),
        ({"exclude": ["lagg"]}, "did you mean 'lag'"),
        ({"false_alarm": 0.0}, "0.0001 to 0.2"),
        ({"exclude": ["gain", "friction", "drift", "lag", "bump", "ripple"]}, "causes to follow"),
    ],
)
def test_bad_input_is_one_line(settings, options, words):
    options = dict(options)
    count = options.pop("count", 3)
    with pytest.raises((InvalidInputError, UnknownNameError), match=words):
        followed(settings, [0.0] * count, **options)


def test_recordings_without_dates_are_numbered_and_some_without_are_refused():
    day = datetime(2026, 3, 2, 9, 30)
    numbered = Calendar.of(["b", "a"], [None, None])
    assert numbered.days == (1.0, 2.0)
    assert (numbered.words(2.0), numbered.unit) == ("recording 2", "recording")
    twice = Calendar.of(["a", "b"], [day, day.replace(hour=15)])
    assert twice.words(0.0) == "2026-03-02 09:30"
    with pytest.raises(InvalidInputError, match="date of b"):
        Calendar.of(["a", "b"], [day, None])
    with pytest.raises(InvalidInputError, match="one for all"):
        trend(Toy(), series(1, [0.0] * 3), Calendar.of(["a", "b", "c"], [day] * 3))
