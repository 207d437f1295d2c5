"""The evaluators: they compute, repeat to the bit, and see it when the rig is another one."""

import shlex

import numpy as np
import pytest

from ves_twin.control.leg_loop import chebyshev_section
from ves_twin.plant.plant import Plant
from ves_twin.procedures.registry import load_procedure
from ves_twin.scenario.load import parse_setting
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.linear.leg_settings import LegSettings
from ves_twin.thesis.claim import load_claims
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Evaluation, NotBuilt, NotRun, NotTestable
from ves_twin.thesis.evaluators import chapter_3, chapter_5
from ves_twin.thesis.evaluators.registry import ANSWERS
from ves_twin.thesis.left_out import plant_without
from ves_twin.thesis.leg_response import bandwidth, leg_response
from ves_twin.thesis.scorecard import score_claims
from ves_twin.thesis.verdict import Verdict

LONG = {
    "C016",
    "C085",
    "C086",
    "C131",
    "C023",
    "C035",
    "C116",
    "C118",
    "C128",
    "C057",
    "C058",
    "C018",
    "C019",
    "C026",
    "C074",
    "C087",
    "C088",
    "C094",
    "C095",
    "C096",
    "C029",
    "C030",
    "C031",
    "C032",
    "C038",
    "C039",
    "C056",
    "C114",
    "C072",
    "C073",
    "C076",
    "C117",
    "C120",
    "C122",
    "C126",
} | {f"C0{number}" for number in range(41, 54)}
"""Claims that take more than a second: once, in the slow test, and again in `make nightly`."""

DEAR = {
    "C016",
    "C018",
    "C019",
    "C023",
    "C026",
    "C035",
    "C038",
    "C039",
    "C041",
    "C042",
    "C057",
    "C058",
    "C085",
    "C086",
    "C087",
    "C088",
    "C094",
    "C095",
    "C096",
    "C114",
    "C116",
    "C118",
    "C131",
}
"""Claims that take four fifths of the time of all, 1 to 17 s each: in `make nightly` alone."""

BUILT = [n for n, a in ANSWERS.items() if not isinstance(a, NotBuilt | NotTestable)]


@pytest.fixture(scope="module")
def nominal():
    return Plant.load("ves2")


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.nightly) if n in LONG else n for n in BUILT]
)
def test_an_evaluation_repeats_to_the_bit_and_has_values_to_compare(claims, nominal, name):
    one, two = (ANSWERS[name](Context(nominal, True), claims[name]) for _ in range(2))
    assert one == two
    if isinstance(one, NotRun):
        assert one.reason
        return
    assert one.note
    assert one.values or one.holds is not None


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_every_claim_is_computed_and_its_commands_exist(nominal, request):
    """Without those that are dear; with them and calibrated without a claim in `make nightly`."""
    context = Context(nominal, quick=True)
    nightly = request.config.getoption("--nightly")
    claims = {n: claim for n, claim in load_claims().items() if nightly or n not in DEAR}
    without = plant_without if nightly else lambda claim: None
    card = score_claims(claims.values(), ANSWERS, context, without=without)
    assert all(row.predicted for row in card.calibrated if without(row.claim.id))
    assert [row.claim.id for row in card.rows] == list(claims)
    for row in card.rows:
        assert row.note, row.claim.id
        assert not row.note.startswith("could not be computed"), row.claim.id
        assert row.command == f"ves-twin reproduce {row.claim.id}"
        for run in row.runs:
            program, verb, scenario, *options = shlex.split(run)
            assert (program, verb) == ("ves-twin", "run")
            changes = [text for text in options if text != "--set"]
            keys = dict(parse_setting(text) for text in changes)
            assert load_procedure(scenario, keys) or Scenario.load(scenario, keys)
    assert card.score["reproduced"] > 0


def test_what_a_short_run_would_answer_otherwise_is_left_to_the_full_one(claims, nominal):
    """4 s of Learning Method come out as reproduced or in kind where 20 s differ."""
    for name in ("C029", "C030", "C031", "C056", "C132"):
        found = ANSWERS[name](Context(nominal, quick=True), claims[name])
        assert isinstance(found, NotRun)
        assert "only the full run" in found.reason


@pytest.mark.nightly
def test_random_wrench_errors_of_a_newton_cost_in_proportion(claims, nominal, monkeypatch):
    """A linear emulation of 20 s: twice the noise with the same seed moves it twice as far, 3 %."""
    one = ANSWERS["C023"](Context(nominal, quick=True), claims["C023"])
    monkeypatch.setattr(chapter_3, "WRENCH_ERROR", [2.0, 2.0, 2.0, 3.0, 3.0, 3.0])
    two = ANSWERS["C023"](Context(nominal, quick=True), claims["C023"])
    assert isinstance(one, Evaluation)
    assert two.values[0] / one.values[0] == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize(
    ("claim", "change"),
    [
        ("C129", {"sensor.corner": 25.0}),
        ("C008", {"clock.tick": 350e-6}),
        ("C078", {"clock.leg_ticks": 6}),
        ("C017", {"arm.mass": [70.0, 12.8, 17.4, 9.0]}),
        ("C060", {"arm.mass": [54.5, 12.8, 17.4, 9.1]}),
        ("C108", {"arm.mass": [54.5, 12.8, 17.5, 9.0]}),
        ("C107", {"arm.a2": 0.43}),
        ("C110", {"arm.armature": [1.14, 4.0, 0.83]}),
        ("C115", {"sensor.position": [0.0, 0.0, 0.18944]}),
        (
            "C112",
            {"arm.com": [[0, 0, 0.2], [0, 0, -0.056], [-0.364, -0.006, 0.016], [-0.142, 0, 0]]},
        ),
        ("C125", {"leg.stroke": 0.25}),
        ("C122", {"sensor.wander": [14.0, 14.0, 14.0, 7.0, 7.0, 7.0]}),
    ],
)
def test_another_rig_gets_another_verdict(verdict_on, nominal, claim, change):
    before, after = verdict_on(claim, nominal), verdict_on(claim, nominal.with_values(change))
    assert before in (Verdict.INPUT, Verdict.REPRODUCED, Verdict.IN_KIND)
    assert after == Verdict.DIFFERS


def test_stiff_legs_lose_the_first_mode(verdict_on, nominal):
    """Without the legs' flexibility there is no mode at 10 to 13 Hz, falling or not."""
    stiff = nominal.with_values({"leg.bending_stiffness": 1.5e5})
    assert verdict_on("C072", nominal) == Verdict.REPRODUCED
    assert verdict_on("C072", stiff) == Verdict.DIFFERS


def test_a_shifted_notch_fails_the_filter_claims(verdict_on, nominal, monkeypatch):
    def shifted(rate):
        return chebyshev_section(rate * 9.0 / 11.0)  # the edge at 11 Hz instead of 9

    monkeypatch.setattr(chapter_5, "chebyshev_section", shifted)
    for claim in ("C081", "C082", "C083", "C084"):
        assert verdict_on(claim, nominal) == Verdict.DIFFERS


def test_the_measured_leg_response_is_that_of_its_parts(nominal):
    """At 1 Hz oil and structure do nothing: integrator, valve lag, one hold of the leg loop.

    Each leg sees its command through kp / (s (1 + s tau)) and a delay of half a leg cycle and a
    tick. 2 % and 1 deg leave room for the payload's weight on the oil.
    """
    found = leg_response(Context(nominal), LegSettings(12.6), 1.0)
    s = 2j * np.pi
    opened = 12.6 / (s * (1 + 0.004 * s)) * np.exp(-s * (0.5 * 5 + 1) * 341e-6)
    closed = opened / (1 + opened)
    assert abs(found.closed) == pytest.approx(abs(closed), rel=0.02)
    assert np.degrees(np.angle(found.closed / closed)) == pytest.approx(0.0, abs=1.0)


@pytest.mark.slow
def test_the_bandwidth_is_where_the_response_is_down_by_3_db(nominal):
    """Two secants on the log of a smooth response leave less than 1 %."""
    context = Context(nominal, quick=True)
    found = bandwidth(context, LegSettings(12.6)).frequency
    there = leg_response(context, LegSettings(12.6), found)
    assert abs(there.closed) == pytest.approx(np.sqrt(0.5), rel=0.01)


def test_a_simulation_is_run_once_in_a_context(nominal):
    context = Context(nominal)
    short = {"run.duration": 0.05, "run.settle": 0.05}
    assert context.run("position_sine", short) is context.run("position_sine", dict(short))
    other = context.run("position_sine", {**short, "legs.gain": 9.0})
    assert other is not context.run("position_sine", short)
