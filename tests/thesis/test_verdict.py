"""Verdicts: made in one place, from the comparison alone."""

from hypothesis import given
from hypothesis import strategies as st

from ves_twin.thesis.claim import Claim, Kind
from ves_twin.thesis.evaluation import Evaluation, NotBuilt, NotRun, NotTestable
from ves_twin.thesis.tolerance import Comparison, Tolerance
from ves_twin.thesis.verdict import Verdict, judge

CLAIM = Claim(
    id="C999",
    where="1.1",
    chapter="1",
    quantity="a number",
    printed="10",
    unit="Hz",
    kind=Kind.EXPERIMENT,
    value=(10.0,),
    tolerance=Tolerance(Comparison.ABSOLUTE, (1.0,)),
    in_kind=Tolerance(Comparison.AT_LEAST, (5.0,)),
)


@given(st.floats(-20.0, 40.0))
def test_reproduced_within_the_tolerance_in_kind_beyond_differs_elsewhere(value):
    found = judge(CLAIM, Evaluation((value,)))
    expected = Verdict.IN_KIND if value >= 5.0 else Verdict.DIFFERS
    assert found == (Verdict.REPRODUCED if 9.0 <= value <= 11.0 else expected)


def test_an_input_that_the_twin_has_is_an_input_and_one_that_it_lacks_differs():
    given_in = CLAIM.model_copy(update={"kind": Kind.INPUT, "in_kind": None})
    assert judge(given_in, Evaluation((10.0,))) == Verdict.INPUT
    assert judge(given_in, Evaluation((12.0,))) == Verdict.DIFFERS


def test_words_can_only_be_met_in_kind():
    words = CLAIM.model_copy(update={"value": (), "tolerance": None})
    assert judge(words, Evaluation((6.0,))) == Verdict.IN_KIND


def test_the_errata_decide_what_is_expected():
    corrected = CLAIM.model_copy(update={"corrected": (20.0,), "in_kind": None})
    assert judge(corrected, Evaluation((20.0,))) == Verdict.REPRODUCED
    assert judge(corrected, Evaluation((10.0,))) == Verdict.DIFFERS


def test_a_failed_condition_beside_good_values_differs():
    assert judge(CLAIM, Evaluation((10.0,), holds=False)) == Verdict.DIFFERS


def test_what_is_not_there_has_a_verdict_of_its_own():
    assert judge(CLAIM, NotBuilt("something")) == Verdict.NOT_BUILT
    assert judge(CLAIM, NotTestable("a reason")) == Verdict.NOT_TESTABLE
    assert judge(CLAIM, NotRun("a reason")) == Verdict.NOT_RUN


def test_inputs_and_calibrated_claims_do_not_count():
    assert CLAIM.counts
    assert not CLAIM.model_copy(update={"kind": Kind.INPUT}).counts
    assert not CLAIM.model_copy(update={"calibrated_on": "leg.gain"}).counts
