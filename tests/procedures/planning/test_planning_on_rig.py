"""The experiments of chapter 4 on the rig: paths with and without compensation, the release."""

import csv

import numpy as np
import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure

pytestmark = pytest.mark.slow

FAST = "ves2_fast"
"""The rig without leg bodies: its platform moves as that of the full one to a few per cent."""


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paths")
    procedure = load_procedure("coupling_map_paths", {"rest": 4.0})
    return folder, procedure.carry_out(RunContext(folder, Plant.load(FAST)))


@pytest.fixture(scope="module")
def release(tmp_path_factory):
    folder = tmp_path_factory.mktemp("release")
    procedure = load_procedure("pped_release_emulated", {"duration": 12.0})
    return folder, procedure.carry_out(RunContext(folder, Plant.load(FAST)))


def test_good_over_bad_on_the_rig_is_within_15_percent_of_zero_gravity(paths, figure):
    """C057; issue 5 asks for 15 %."""
    emulated = paths[1].values["emulated"]
    assert emulated["good_over_bad"] < 0.5
    off = 100 * abs(emulated["good_over_bad_against_zero_g"] - 1.0)
    figure("rig: good over bad path against zero-g", off, 15.0, "%")
    assert off < 15.0
    for name in ("good", "straight", "bad"):
        assert emulated[name]["outcome"] == "completed"
        ideal = paths[1].values["zero_g"][name]["peak_energy"]
        np.testing.assert_allclose(emulated[name]["peak_energy_ideal"], ideal, rtol=1e-3)


def test_without_compensation_the_result_is_useless(paths):
    """C058."""
    runs = paths[1].values["uncompensated"]
    assert min(run["over_emulated"] for run in runs.values()) > 5.0
    assert runs["good"]["outcome"] == "leg_limit"  # the bad one takes longer than the test


def test_the_written_rig_runs_hold_the_peaks(paths):
    with (paths[0] / "paths_on_rig.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    table = np.array(rows, float)
    assert len(head) == 1 + 2 * 3
    for kind in ("emulated", "uncompensated"):
        column = table[:, head.index(f"good.{kind}.energy [J]")]
        peak = paths[1].values[kind]["good"]["peak_energy"]
        np.testing.assert_allclose(np.nanmax(column), peak, rtol=1e-8)


def test_linear_and_nonlinear_predictions_of_the_release_agree(release):
    values = release[1].values["emulated"]
    for name in ("pped", "high", "energy"):
        for kind in ("ideal", "leg_lag"):
            found = values[name]
            np.testing.assert_allclose(found[kind], found[f"linear_{kind}"], rtol=0.005)


def test_the_order_of_the_gains_survives_on_the_rig_and_the_gap_shrinks(release):
    values = release[1].values["emulated"]
    for shares in (values["less_than_pped"], values["pped_less_than_high"]):
        assert 0.01 < shares["rig"] < shares["leg_lag"] < shares["ideal"]


@pytest.mark.parametrize(("friction", "optimum"), [(False, 0.173), (True, 0.144)])
def test_behind_the_legs_the_linear_gains_are_worth_what_the_docs_say(friction, optimum):
    """Issue 5: about 15 to 19 % for the optimum, 3 to 4 % for PPED; split inertias here."""
    plant = Plant.load("ves2")
    procedure = load_procedure("pped_release_emulated", {"friction": friction})
    linear = {
        name: procedure.prediction(plant, gains)
        for name, gains in procedure.gain_sets(plant).items()
    }
    optimised, pped, high = (linear[name].leg_lag for name in ("energy", "pped", "high"))
    assert abs(1 - optimised / pped - optimum) < 0.002  # where the search stops
    assert 0.025 < 1 - pped / high < 0.04


def test_legs_alone_take_more_energy_than_any_gains(release):
    values = release[1].values["emulated"]
    taken = 1.0 - values["locked"]["linear_leg_lag"] / values["locked"]["linear_ideal"]
    assert taken > values["less_than_pped"]["ideal"]


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("pped_release_emulated", {"rig.legs_gian": 12.0}, ["legs_gian", "legs_gain"]),
        ("coupling_map_paths", {"rig.gravity_file": "ves2_48_poses"}, ["ves2_47_poses"]),
    ],
)
def test_wrong_rig_options_are_refused_in_one_line(tmp_path, name, changes, words):
    with pytest.raises(VesTwinError) as caught:
        load_procedure(name, changes).carry_out(RunContext(tmp_path, Plant.load(FAST)))
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)
    assert not list(tmp_path.iterdir())
