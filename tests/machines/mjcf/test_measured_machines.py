"""Machines of measured public data: what the page of measured machines says is named, is."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import diagnose

sys.path.append(str(Path(__file__).parents[3] / "benchmarks"))
from real import eha_hydraulic_cylinder

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
