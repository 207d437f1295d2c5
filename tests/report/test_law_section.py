"""A law in a report: what is claimed, what it is worth, what else it could be, and its picture."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from ves_twin.cli.diagnose import held_out_table, law_lines
from ves_twin.diagnosis.law.result import LawFinding, LawNumber, LawRival
from ves_twin.diagnosis.unseen.gain import Gain
from ves_twin.diagnosis.verdict.verdict import Basis, ChannelError, Kind, Statistics, Verdict
from ves_twin.report.diagnosis.answer import verdict_sentence
from ves_twin.report.diagnosis.law import (
    draw_law,
    law_figure,
    law_heading,
    law_parts,
    law_sentences,
    worth_sentence,
)

X = np.linspace(-5.0, 5.0, 11)
Y = -0.02 * np.abs(X) * X

LAW = LawFinding(
    claimed=True,
    reason="",
    place="joint",
    kind="effort",
    of=("speed@joint",),
    units=("rad/s", "N*m"),
    shape="table",
    form="-0.02 |x| x",
    numbers=(LawNumber("factor of |x| x", -0.02, -0.021, -0.019),),
    knots=(tuple(X.tolist()),),
    values=tuple(Y.tolist()),
    band=(tuple(X.tolist()), tuple((Y - 0.01).tolist()), tuple((Y + 0.01).tolist())),
    seen=((-5.0, 5.0),),
    points=((0.0, 1.0), (0.0, -0.02), (0.01, 0.01)),
    transient=False,
    nats=812.0,
    misfit=1.2,
    misfit_limit=5.0,
    further=-3.0,
    also=(LawRival("joint(speed@joint): cubic", "-0.004 x^3", 1.0, True),),
    gain=Gain(0.97, 0.95, 0.98, 12.0, 1.3, {}, 9.0),
)


def verdict(law: LawFinding) -> Verdict:
    basis, figures = Basis("measured", "declared", "measured"), Statistics(1.0, 2.0, 9.0, 5.0)
    return Verdict(Kind.UNKNOWN, basis, figures, law=law)


def test_a_claimed_law_is_told_with_its_gain_its_range_and_what_is_as_good():
    said = " ".join(law_sentences(LAW))
    for words in ("-0.02 |x| x", "97 %", "812 nats", "-5", "never measured", "-0.004 x^3"):
        assert words in said
    assert verdict_sentence(verdict(LAW)).endswith("depends on its speed: -0.02 |x| x.")


def test_without_a_claim_the_reason_and_the_place_are_told_and_no_law():
    none = replace(LAW, claimed=False, reason="what it leaves is not noise", form="")
    said = law_sentences(none)[0]
    assert said.startswith("No law is claimed: what it leaves is not noise.")
    assert "joint" in said
    assert "A law does" not in verdict_sentence(verdict(none))


def test_a_reader_is_sent_to_a_law_without_a_claim_only_if_it_is_worth_something():
    none = replace(LAW, claimed=False, reason="what it leaves is not noise")
    idle = replace(none, gain=replace(LAW.gain, share=0.0))
    assert "look there first" in law_sentences(none)[0]
    assert "look there" not in law_sentences(idle)[0]
    assert len(law_sentences(idle)) == 1 < len(law_sentences(none))
    assert "<li>" not in "".join(map(str, law_parts(idle)))
    grows = replace(none, gain=replace(LAW.gain, errors={"joint": (1.0, 1.6)}))
    assert "look there" not in law_sentences(grows)[0]


def test_a_caption_speaks_of_points_only_where_points_are_drawn():
    drawn, bare = (str(law_figure(law)) for law in (LAW, replace(LAW, points=())))
    assert "Points" in drawn
    assert "Points" not in bare


def test_a_law_of_time_says_that_it_foretells_nothing():
    drift = replace(LAW, of=("time",), units=("s", "N*m"), transient=True)
    assert any("foretells nothing" in text for text in law_sentences(drift))


def test_a_law_without_held_out_recordings_is_a_candidate():
    assert "no held-out recordings" in replace(LAW, gain=None).refusal
    assert LAW.refusal == ""


@pytest.mark.parametrize("shape", ["table", "play"])
def test_the_section_has_a_picture_where_there_is_something_to_draw(shape):
    law = LAW if shape == "table" else replace(LAW, shape="play", of=(), seen=(), knots=(), band=())
    text = "".join(map(str, law_parts(law)))
    assert ("<svg" in text) == (shape == "table")
    assert "factor of |x| x" in text


def test_the_heading_claims_no_law_where_none_is_claimed():
    assert law_heading(LAW) == "A law in place of a cause"
    assert law_heading(replace(LAW, part=True)) == "A law of what the causes leave"
    assert "missing" in law_heading(
        replace(LAW, claimed=False, reason="what it leaves is not noise")
    )


def test_odds_beyond_doubt_are_not_counted():
    assert "over 1000 nats" in worth_sentence(replace(LAW, nats=7.8e9))
    assert f"{LAW.nats:.0f} nats" in worth_sentence(LAW)


def test_a_picture_shows_law_band_recordings_and_truth():
    figure = draw_law(LAW, lambda x: -0.02 * np.abs(x) * x)
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert set(labels) == {"law", "90 % band", "recordings", "truth"}


def test_a_verdict_with_a_law_is_json_with_the_law_in_it():
    told = json.loads(verdict(LAW).to_json())["law"]
    assert told["form"] == "-0.02 |x| x"
    assert told["gain"]["share"] == 0.97


def test_a_law_of_what_causes_leave_has_a_column_of_the_held_out_table():
    """A servo's causes took 1 % of the held-out error, its law 77 % of the rest, told nowhere."""
    error = ChannelError(9.0, 8.0, 0.65, 0.59, "rad", 0.7)
    causes = Gain(0.02, 0.0, 0.1, 12.0, 11.8, {"joint.position": (0.596, 0.590)})
    beside = replace(
        LAW, part=True, gain=replace(causes, errors={"joint.position": (0.590, 0.136)})
    )
    told = replace(verdict(beside), gain=causes, residuals={"joint.position": error})
    rows = held_out_table(told)
    assert "after  with law" in rows[1]
    assert rows[-1].split()[-3:] == ["0.59", "0.136", "rad"]
    assert "with law" not in " ".join(held_out_table(replace(told, law=LAW)))


def test_a_law_beside_a_cause_whose_range_ended_may_stand_for_the_rest_of_it():
    """A reaction wheel's friction had a law beside a rod of which the range let half a kilogram go."""
    said = " ".join(law_sentences(LAW, ["body mass at rod"]))
    assert "the range of body mass at rod ended: it may stand for the rest of that" in said
    assert "ended" not in " ".join(law_sentences(LAW))


def test_a_terminal_tells_what_a_law_is_worth_once():
    """Beside causes the first line was what was seen: what the law takes away stood nowhere."""
    alone, beside = verdict(LAW), verdict(replace(LAW, part=True))
    assert "It takes away" not in " ".join(law_lines(alone))  # how sure says it
    assert law_lines(beside)[0].startswith("law       It takes away 97 %")
    assert law_lines(replace(alone, law=None)) == []
