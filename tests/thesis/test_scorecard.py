"""The scorecard: nothing circular in the score, leave-one-out beside what was tuned, the page."""

import json
from dataclasses import replace

import pytest

from ves_twin.core.errors import UnreachableError
from ves_twin.core.resources import resource_folder
from ves_twin.plant.plant import Plant
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Evaluation, NotBuilt, NotRun, NotTestable
from ves_twin.thesis.left_out import plant_without
from ves_twin.thesis.page import scorecard_page
from ves_twin.thesis.row import NOT_COMPUTED
from ves_twin.thesis.scorecard import score_claims
from ves_twin.thesis.store import Store
from ves_twin.thesis.verdict import Verdict


@pytest.fixture(scope="module")
def context():
    return Context(Plant.load("ves2"))


def stroke(context, claim):
    return Evaluation((context.plant.parameters.number("leg.stroke"),), note="read off")


@pytest.fixture(scope="module")
def answers(claims):
    """Every claim answered by the stroke, but one of each other kind of answer."""
    return {
        **dict.fromkeys(claims, stroke),
        "C020": NotTestable("a reason"),
        "C029": NotBuilt("a thing"),
    }


def test_the_score_leaves_out_inputs_and_what_was_tuned(claims, answers, context):
    card = score_claims(claims.values(), answers, context)
    counted = [c for c in claims.values() if c.kind != "input" and not c.calibrated_on]
    assert sum(card.score.values()) == len(counted)
    assert card.score["input"] == 0
    assert sum(card.inputs.values()) == sum(c.kind == "input" for c in claims.values())
    assert sum(card.score.values()) + sum(card.inputs.values()) + len(
        [r for r in card.calibrated if r.claim.kind != "input"]
    ) == len(claims)


def test_a_tuned_claim_shows_what_a_rig_tuned_without_it_gives(claims, answers, context):
    shorter = context.plant.with_values({"leg.stroke": 0.4})
    tuned = claims["C074"]
    card = score_claims([tuned], answers, context, without=lambda name: shorter)
    assert card.rows[0].values == (0.5,)
    assert card.rows[0].to_dict()["leave_one_out"]["twin"] == [0.4]
    assert "0.4 Hz" in scorecard_page(card)
    nothing = score_claims([tuned], answers, context, without=lambda name: None)
    assert nothing.rows[0].to_dict()["leave_one_out"] == NOT_COMPUTED
    free = score_claims([claims["C010"]], answers, context, without=lambda name: shorter)
    assert free.rows[0].to_dict()["leave_one_out"] is None


def test_commands_on_a_rig_tuned_without_a_claim_name_its_file(claims, answers, context):
    def told(context, claim):
        return Evaluation((0.5,), runs=(context._command("position_sine", {}),))

    card = score_claims([claims["C041"]], {"C041": told}, context)
    command = card.rows[0].predicted.runs[0]
    file = resource_folder("models").parent / command.split("--plant ")[1]
    assert Plant.load(str(file)).hash == plant_without("C041").hash


def test_rigs_calibrated_without_a_claim_are_plant_files(tmp_path, monkeypatch):
    monkeypatch.setattr("ves_twin.thesis.left_out.resource_folder", lambda name: tmp_path)
    (tmp_path / "thesis" / "left_out").mkdir(parents=True)
    content = 'schema = 1\nname = "no_C074"\nbase = "ves2"\n[parameters]\n"leg.stroke" = 0.4\n'
    (tmp_path / "thesis" / "left_out" / "C074.toml").write_text(content)
    assert plant_without("C074").parameters.number("leg.stroke") == 0.4
    assert plant_without("C072") is None


def test_a_claim_that_cannot_be_computed_differs_and_says_why(claims, context):
    def fails(context, claim):
        raise UnreachableError("leg 3 is too short")

    row = score_claims([claims["C010"]], {"C010": fails}, context).rows[0]
    assert row.verdict == Verdict.DIFFERS
    assert "leg 3 is too short" in row.note


def test_the_page_names_every_claim_and_shows_the_score_first(claims, answers, context):
    card = score_claims(claims.values(), answers, context)
    page = scorecard_page(card)
    for name in claims:
        assert name in page
    score = page.split("\n")[2]
    assert f"{sum(card.score.values())} are neither inputs nor were used in calibration" in score
    for verdict in Verdict:
        if verdict not in (Verdict.INPUT, Verdict.DIFFERS, Verdict.NOT_RUN):
            assert f"{card.score[verdict]} {verdict}" in score


def test_what_only_the_full_run_tells_is_not_run_in_the_quick_one_and_not_kept(
    claims, context, tmp_path
):
    def full_only(context, claim):
        return NotRun("takes long") if context.quick else stroke(context, claim)

    store, chosen = Store(tmp_path), [claims["C010"], claims["C132"]]
    answers = dict.fromkeys(("C010", "C132"), full_only)
    quick = replace(context, quick=True)
    heavier = context.plant.with_values({"platform.mass": 61.0})
    card = score_claims(chosen, answers, quick, store, without=lambda name: heavier)
    assert {row.verdict for row in card.rows} == {Verdict.NOT_RUN}
    assert "1 not run" in scorecard_page(card)
    assert "takes long" in scorecard_page(card)
    assert card.to_dict()["rows"][1]["leave_one_out"] == NOT_COMPUTED
    assert not list(tmp_path.rglob("*.json"))
    full = score_claims(chosen, answers, context, store, without=lambda name: None)
    assert full.score["not run"] == 0
    assert "not run" not in scorecard_page(full)


def test_the_scorecard_is_json_even_where_a_value_is_not_finite(claims, answers, context):
    def wild(context, claim):
        return Evaluation((float("nan"), float("inf")))

    card = score_claims(claims.values(), {**answers, "C010": wild}, context)
    content = json.loads(json.dumps(card.to_dict(), allow_nan=False))
    assert [row["id"] for row in content["rows"]] == list(claims)
    assert content["rows"][9]["twin"] == [None, None]


def test_an_evaluation_is_kept_for_its_own_plant_and_context_only(claims, context, tmp_path):
    calls = []

    def counted(context, claim):
        calls.append(claim.id)
        return Evaluation((0.1 + 0.2, 1e300), holds=True, note="a | b", runs=("one", "two"))

    store, chosen, answers = Store(tmp_path), [claims["C010"]], {"C010": counted}
    first = score_claims(chosen, answers, context, store).rows[0].found
    assert score_claims(chosen, answers, context, store).rows[0].found == first
    assert len(calls) == 1
    heavier = replace(context, plant=Plant.load("ves2").with_values({"platform.mass": 61.0}))
    score_claims(chosen, answers, heavier, store)
    score_claims(chosen, answers, replace(context, quick=True), store)
    assert len(calls) == 3
    for path in tmp_path.rglob("*.json"):
        path.write_text("{")
    assert score_claims(chosen, answers, context, store).rows[0].found == first
    assert len(calls) == 4


def test_a_store_that_cannot_be_written_costs_only_time(claims, context, tmp_path):
    (tmp_path / "file").write_text("")
    store = Store(tmp_path / "file")
    card = score_claims([claims["C010"]], {"C010": stroke}, context, store)
    assert card.rows[0].values == (0.5,)
