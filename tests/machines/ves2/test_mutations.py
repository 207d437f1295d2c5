"""What the parts of the diagnosis are worth: a fixed blind suite of pendulums, marked with each part on and off.

Recordings are those of the blind generator (Runge-Kutta at half the step, another rig each time, counts, a disturbance);
the score is the one that `ves-twin blind score` gives.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pendulum import BIAS, BLIND, FRICTION, LATE_COMMAND, SPRING, exact
from scipy.signal import lfilter

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.fit.search import Search
from ves_twin.diagnosis.settings import Settings
from ves_twin.suites.answers import Answer
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.score import score as scored
from ves_twin.suites.truth import Hidden, HiddenCause, Truth

PLANT = exact()
SINGLES = {
    "coulomb_friction@joint": (FRICTION, 0.006),
    "joint_spring@joint": (SPRING, 0.03),
    "sensor_offset@joint.angle.1": (BIAS, -0.018),
}
"""Each about 15 sigma."""

OUTSIDE = {"quadratic_drag": 0.02, "late_drift": 0.05, "soft_stop": 4.0}
SLOW = 0.97
"""Lag-one coefficient, at 500 Hz, of a rate sensor with a low-pass of 2.4 Hz."""


def truth(n: int, hidden: Hidden, label: str = "") -> Truth:
    causes = (HiddenCause(*label.split("@"), {"size": 1.0}, 15.0),) if label else ()
    kind = "any" if hidden is Hidden.OUTSIDE else ""
    return Truth(f"{hidden}-{n}", hidden, causes, kind)


def measured(seed: int, departure: tuple[str, float] | None = None, outside: str = "") -> Recording:
    rng = np.random.default_rng([seed, 5])
    values = BLIND.commissioned(rng)
    values[LATE_COMMAND] = 0.0  # a twin of the sensor's delay, and no part of this library
    if departure:
        name, size = departure
        values[name] = values.get(name, 0.0) + size
    rig = BlindRig(values, outside, OUTSIDE.get(outside, 0.0))
    return BLIND.record(rig, "train", rng)


def slow_noise(recording: Recording, seed: int) -> Recording:
    """The same record through a rate sensor whose noise has a memory of 70 ms."""
    white = np.random.default_rng([seed, 6]).standard_normal(len(recording))
    slow = 0.01 * np.sqrt(1.0 - SLOW**2) * lfilter([1.0], [1.0, -SLOW], white)
    rate = recording["joint.rate"] + slow[:, None]
    return replace(recording, signals={**recording.signals, "joint.rate": rate})


NONE = [(truth(n, Hidden.NONE), measured(n)) for n in range(3)]
SINGLE = [
    (truth(n, Hidden.SINGLE, label), measured(10 + n, departure))
    for n, (label, departure) in enumerate(SINGLES.items())
]
LACKING = [
    (truth(n, Hidden.OUTSIDE), measured(20 + n, outside=kind)) for n, kind in enumerate(OUTSIDE)
]
SLOW_NONE = [(t, slow_noise(recording, n)) for n, (t, recording) in enumerate(NONE)]

EXACT, QUIET = "single, d 10 to 20: exact", "nothing hidden: nothing said"
ABSTAINS = "a kind that the library lacks, detected: abstains"


@pytest.fixture(scope="module")
def settings(banks):
    return Settings(nulls=40, cache=banks)


@pytest.fixture(scope="module")
def still():
    rng = np.random.default_rng(40)
    return slow_noise(BLIND.record(BlindRig(), "standstill", rng), 40)


def score(cases, settings, plant=None, **material) -> dict[str, tuple[int, int]]:
    """Counts of hits, as `ves-twin blind score` scores these answers."""
    plant = plant or PLANT
    answers = {
        t.case: Answer.of(diagnose(plant, [recording], settings=settings, **material), 0.0)
        for t, recording in cases
    }
    rows = scored([t for t, _ in cases], answers).rows
    return {name: (rate.hits, rate.of) for name, rate in rows.items()}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suite", "row"),
    [
        pytest.param(NONE, QUIET, id="in order"),
        pytest.param(SINGLE, EXACT, id="one cause"),
        pytest.param(LACKING, ABSTAINS, id="outside", marks=pytest.mark.nightly),
    ],
)
def test_intact_the_suite_has_full_marks(suite, row, settings, cases):
    count = cases(3)
    assert score(suite[:count], settings)[row] == (count, count)


@pytest.mark.slow
def test_intact_noise_with_a_memory_is_left_in_peace(settings, still, cases):
    count = cases(3)
    assert score(SLOW_NONE[:count], settings, standstill=still)[QUIET] == (count, count)


@pytest.mark.nightly
def test_without_nuisances_every_rig_in_order_is_called_faulty(tmp_path, cases):
    """What scales, a stop watch and a datasheet leave open then has to be some cause."""
    count, sure = cases(3), exact(sd=0.0)
    settings = Settings(nulls=40, cache=tmp_path)
    assert score(NONE[:count], settings, sure)[QUIET] == (0, count)


@pytest.mark.nightly
def test_without_whitening_noise_with_a_memory_is_called_a_fault(
    monkeypatch, tmp_path, still, cases
):
    """Samples are then taken as independent: the slow part of the noise is counted many times."""
    monkeypatch.setattr("ves_twin.diagnosis.record.whitening.prediction_filters", unfiltered)
    monkeypatch.setattr("ves_twin.diagnosis.record.whitening.COLOURS", np.zeros(1))
    settings, count = Settings(nulls=40, cache=tmp_path), cases(3)
    assert score(SLOW_NONE[:count], settings, standstill=still)[QUIET] == (0, count)


def unfiltered(covariance):
    return np.eye(1, covariance.shape[1]).repeat(len(covariance), axis=0)


@pytest.mark.slow
def test_without_refinement_nobody_is_named(monkeypatch, settings, cases):
    """The bank's nearest size beside nominal commissioning errors leaves more than noise."""
    monkeypatch.setattr(Search, "descend", lambda _, point, jacobian: (point, jacobian))
    count = cases(3)
    assert score(SINGLE[:count], settings)[EXACT] == (0, count)


@pytest.mark.slow
def test_without_adequacy_what_the_library_lacks_gets_a_name_of_it(monkeypatch, settings, cases):
    """The best of eight wrong causes is named, since nobody asks whether it leaves noise."""
    monkeypatch.setattr("ves_twin.diagnosis.explain.judge.misfit", lambda *a: 0.0)
    monkeypatch.setattr("ves_twin.diagnosis.explain.judge._second", lambda *a: 0.0)
    monkeypatch.setattr("ves_twin.diagnosis.explain.judge.pull_limit", lambda *a: np.inf)
    count = cases(3)
    hits, of = score(LACKING[:count], settings)[ABSTAINS]
    assert of == count
    assert hits <= count // 3
