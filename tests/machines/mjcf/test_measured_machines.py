"""Machines of measured public data: what the pages of measured machines and of laws say."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import diagnose

sys.path.append(str(Path(__file__).parents[3] / "benchmarks"))
from real import damper, eha_hydraulic_cylinder, tx40

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(1800)]

QUICK = Settings(nulls=10)
"""Thresholds matter little where causes stand out by thousands of chi^2."""


def found_of(one):
    return diagnose(one.fitted, one.rig, held_out=one.held_out, settings=QUICK)


def sizes(found, label):
    (cause,) = (c for c in found.verdict.causes if f"{c.effect}@{c.target}" == label)
    return cause, {name: size.value for name, size in cause.parameters.items()}


@pytest.fixture(scope="module", params=eha_hydraulic_cylinder.TRUTH)
def cylinder(request, data_folder, tmp_path_factory):
    every = eha_hydraulic_cylinder.sets(data_folder, tmp_path_factory.mktemp("cylinder"))
    truth = eha_hydraulic_cylinder.TRUTH[request.param]
    (one,) = (s for s in every if s.name == f"cylinder, {truth} N")
    return truth, found_of(one)


def test_the_load_on_a_cylinder_is_named_to_ten_per_cent(cylinder):
    truth, found = cylinder
    cause, size = sizes(found, "one_way_load@stroke")
    assert cause.firm
    assert size["load"] == pytest.approx(truth, rel=0.10)


def test_how_late_a_cylinders_shown_speed_is_comes_out_to_a_fifth(cylinder):
    """Averages over 20 and 100 ms are 60 ms late together."""
    cause, size = sizes(cylinder[1], "sensor_delay@shown.speed")
    assert cause.firm
    assert size["delay"] == pytest.approx(0.060, rel=0.20)


def law_without(one, *kinds):
    """What a search says of a set whose library lacks some kinds."""
    settings = replace(QUICK, laws=True)
    found = diagnose(one.fitted, one.rig, held_out=one.held_out, exclude=kinds, settings=settings)
    assert found.verdict.law is not None
    return found.verdict.law


def test_what_a_damper_lacks_without_its_friction_behind_a_gap_is_a_play(data_folder, tmp_path):
    (one,) = damper.sets(data_folder, tmp_path)
    law = law_without(one, "friction_behind_gap", "backlash")
    assert law.place == "stroke"
    assert law.of[0].startswith("position@stroke within ")
    assert law.gain.share > 0.9


def test_what_an_arm_lacks_without_its_couplings_is_of_two_axes_together(data_folder, tmp_path):
    one = tx40.sets(data_folder, tmp_path)[0]
    law = law_without(one, "coupling_viscous", "coupling_coulomb", "coupling_inertia")
    assert law.part
    assert (law.place, law.of) == ("joint_5 + joint_6", ("speed@joint_5 + joint_6",))
    before, after = law.gain.errors["torque.6"]
    assert before > 1.3  # by friction of joint 6 alone
    assert after == pytest.approx(0.908, rel=0.05)  # the couplings themselves leave that, offered
