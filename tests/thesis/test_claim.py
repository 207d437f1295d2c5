"""The claims as data: complete, well formed, each answered once."""

import re

import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.plant.plant import Plant
from ves_twin.thesis.claim import Kind, load_claims
from ves_twin.thesis.evaluation import NotBuilt, NotTestable
from ves_twin.thesis.evaluators import (
    appendices_d_and_f,
    appendix_a,
    appendix_b,
    appendix_e,
    chapter_2,
    chapter_3,
    chapter_4,
    chapter_5,
    gravity_methods,
)
from ves_twin.thesis.evaluators.registry import ANSWERS
from ves_twin.thesis.tolerance import Comparison

IDS = [f"C{number:03d}" for number in range(1, 133)]


def test_there_are_132_claims_in_order(claims):
    assert list(claims) == IDS


def test_each_claim_is_answered_exactly_once(claims):
    parts = (
        chapter_2.CHAPTER_2,
        chapter_3.CHAPTER_3,
        chapter_4.CHAPTER_4,
        chapter_5.CHAPTER_5,
        appendix_a.APPENDIX_A,
        appendix_b.APPENDIX_B,
        appendices_d_and_f.APPENDICES_D_AND_F,
        appendix_e.APPENDIX_E,
        gravity_methods.GRAVITY_METHODS,
    )
    assert sorted(name for part in parts for name in part) == IDS
    assert set(ANSWERS) == set(IDS)


@pytest.mark.parametrize("name", IDS)
def test_a_claim_can_be_judged_unless_nothing_can_test_it(claims, name):
    claim, answer = claims[name], ANSWERS[name]
    asked = [t for t in (claim.tolerance, claim.in_kind) if t is not None]
    assert asked or isinstance(answer, NotTestable)
    for tolerance in asked:
        compares = tolerance.kind in (Comparison.EXACT, Comparison.ABSOLUTE, Comparison.RELATIVE)
        assert claim.expected or not compares
        if compares:
            assert len(tolerance.limit) in (0, 1, len(claim.expected))
    assert not claim.corrected or (len(claim.corrected) == len(claim.value) and claim.errata)
    assert all(re.fullmatch(r"E-\d{1,2}", e) for e in claim.errata)
    assert not claim.figure or re.fullmatch(r"fig-\d-\d{1,2}", claim.figure)
    if isinstance(answer, NotBuilt | NotTestable):
        assert vars(answer) != {"needs": ""} != {"reason": ""}


def test_what_was_tuned_on_a_claim_exists(claims):
    parameters = Plant.load("ves2").parameters
    for claim in claims.values():
        for name in re.findall(r"[a-z]+\.[a-z_]+", claim.calibrated_on):
            assert name in parameters, claim.id


def test_every_calibrated_number_of_the_plant_that_cites_a_claim_is_named_by_one(claims):
    """Numbers tuned on section 5.2 must not let a row of 5.2 into the score."""
    named = " ".join(claim.calibrated_on for claim in claims.values())
    for name, parameter in Plant.load("ves2").parameters.items():
        if parameter.grade.value == "calibrated" and "thesis 5" in parameter.source:
            assert name in named


GOOD = """schema = 1
[C001]
where = "2.2"
chapter = "2"
quantity = "a number"
printed = "6"
unit = "1"
kind = "input"
value = 6
tolerance = { kind = "exact" }
"""


def test_a_file_of_ones_own_is_read(tmp_path):
    (tmp_path / "claims.toml").write_text(GOOD)
    assert load_claims(str(tmp_path / "claims.toml"))["C001"].value == (6.0,)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("schema = 1", "schema = 2"), "schema"),
        (('kind = "input"', 'kind = "inptu"'), "did you mean 'input'"),
        (("quantity", "quantitty"), "did you mean 'quantity'"),
        (('unit = "1"', "unit = 1"), "C001: unit: got 1, expected a valid string"),
        (("value = 6", 'value = "six"'), "value.*'six', expected a valid number"),
        (("value = 6", "value = true"), "value.*expected a valid number"),
        (('kind = "exact"', 'kind = "about"'), "comparison 'about'; did you mean 'absolute'"),
        (("[C001]\n", "C002 = 3\n[C001]\n"), "a table"),
    ],
)
def test_a_broken_file_is_refused_in_one_line(tmp_path, change, says):
    (tmp_path / "claims.toml").write_text(GOOD.replace(*change))
    with pytest.raises(VesTwinError, match=says):
        load_claims(str(tmp_path / "claims.toml"))


@pytest.mark.parametrize(
    "wrong",
    ["kind = {a = 1}", "kind = [1]", "errata = true", "errata = 3", "tolerance = {kind = {}}"],
)
def test_a_claim_of_wrong_kinds_is_refused_in_one_line(wrong, tmp_path):
    texts = "".join(f'{key} = "x"\n' for key in ("where", "chapter", "quantity", "printed", "unit"))
    kind = "" if wrong.startswith("kind") else f'kind = "{next(iter(Kind))}"\n'
    (tmp_path / "claims.toml").write_text(f"schema = 1\n[a]\n{texts}{kind}{wrong}\n")
    with pytest.raises(VesTwinError) as caught:
        load_claims(str(tmp_path / "claims.toml"))
    assert "\n" not in str(caught.value)
