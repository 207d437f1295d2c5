"""Chapter 5's stability claims hold in the full plant, and fail where their causes are removed."""

import json
import subprocess
import sys

import numpy as np
import pytest
from sizes import nightly_but

import ves_twin as vt
from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.resources import resource_folder
from ves_twin.plant.modes import structural_modes
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure
from ves_twin.procedures.stability.stability_bench import StabilityBench

RIGID = {"leg.bending_stiffness": 3e5, "leg.bending_damping": 60.0}
STIFF_OIL = {"hydraulics.oil_stiffness": 4e7, "hydraulics.oil_damping": 8e4}
HIGH_GAIN = 20.0  # 1/s, K1 = 20000 by docs/calibration.md
VIBRATION = (10.0, 13.2)  # Hz, thesis 5.2


def bench(gain, place="none", edge=9.0, plant="ves2", changes=None):
    settings = {"legs.gain": gain, "legs.filter": place, "legs.edge": edge}
    world = vt.Plant.load(plant).with_values(changes or {})
    return StabilityBench(world, vt.Scenario.load("beam_horizontal_truth", settings))


def share(*arguments, **changes):
    return bench(*arguments, **changes).mass_limit(10.0, 150.0).share


def test_without_filter_the_raised_gain_vibrates_at_the_legs_bending(figure):
    assert bench(12.6).vibration().growth < 0.0
    mode = bench(16.0).vibration()
    assert mode.growth > 0.0
    assert mode.frequency >= VIBRATION[0]
    figure("vibration of the 20 kg beam at gain 16, no filter", mode.frequency, VIBRATION[1], "Hz")


def test_vibration_claim_fails_without_the_legs_flexibility():
    """Rigid legs still oscillate on the oil, above the band; with stiff oil, not at all."""
    plant = vt.Plant.load("ves2").with_values(RIGID)
    modes = structural_modes(plant, np.zeros(6), np.zeros(3))
    assert min(m.frequency for m in modes if m.damping < 0.3) > VIBRATION[1]
    assert bench(16.0, changes=RIGID).vibration().frequency > VIBRATION[1]
    assert bench(16.0, changes=RIGID | STIFF_OIL).vibration().growth < 0.0


@pytest.mark.nightly
def test_filter_claims_fail_with_the_notch_elsewhere():
    """An octave down the error's limit leaves its range; an octave up feedback is hardly wider."""
    assert 0.45 <= share(19.0, "error") <= 0.65
    assert not 0.45 <= share(19.0, "error", edge=4.5) <= 0.65
    assert share(19.0, "feedback") < 0.65 * share(19.0, "error")
    assert share(19.0, "feedback", edge=18.0) > 0.75 * share(19.0, "error", edge=18.0)


@pytest.mark.slow
def test_rigid_plant_has_the_limits_of_one_axis():
    """What the full plant adds to the one axis is compliance: without it they agree to 5 %."""
    from ves_twin.procedures.stability.one_axis import OneAxis

    plant = vt.Plant.load("ves2").with_values(RIGID | STIFF_OIL)
    axis = OneAxis.of(plant, 20.9, FilterPlace.ERROR, 9.0, 80.0)
    rigid = share(20.9, "error", changes=RIGID | STIFF_OIL)
    assert rigid == pytest.approx(axis.lowest_stable_ratio(), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("plant", nightly_but(1, ["ves2", "ves2_pressure_fitted"]))
def test_filter_on_the_error_needs_half_the_payload_and_on_the_feedback_less(plant, figure):
    limits = {place: share(HIGH_GAIN, place, plant=plant) for place in ("error", "feedback")}
    assert limits["error"] >= 0.45
    figure(f"{plant}: lowest stable mass, filter on the error", limits["error"], 0.65, "payloads")
    figure(f"{plant}: same, on the feedback", limits["feedback"], 0.40, "payloads")


@pytest.mark.slow
def test_map_is_written_and_runs_confirm_it(tmp_path):
    changes = {
        "gains": [20.9],
        "filters": ["error"],
        "confirm": [20.9],
        "duration": 12.0,
        "workers": 1,
    }
    account = load_procedure("stability_map", changes).carry_out(RunContext(tmp_path))
    (point,) = json.loads((tmp_path / "stability_map.json").read_text())["points"]
    assert (tmp_path / "stability_map.png").stat().st_size > 20_000
    below, above = point["runs"]
    assert (below["verdict"], above["verdict"]) == ("growing", "decaying")
    for run in (below, above):
        # four standard errors, and what other modes of the plant add
        assert abs(run["rate"] - run["expected"]) < 4.0 * run["sd"] + 0.05
        assert run["frequency"] == pytest.approx(point["frequency"], abs=0.3)
    assert account.values["points"][0]["share"] == pytest.approx(point["limit"] / point["payload"])


def test_range_the_wrong_way_round_is_refused(tmp_path):
    procedure = load_procedure("stability_map", {"lightest": 200.0})
    with pytest.raises(InvalidInputError, match="lightest: got 200"):
        procedure.carry_out(RunContext(tmp_path))


def test_scenario_that_emulates_nothing_is_refused():
    scenario = vt.Scenario.load("position_sine")
    with pytest.raises(InvalidInputError, match=r"platform\.mode: got 'position'"):
        StabilityBench(vt.Plant.load("ves2"), scenario)


def test_a_scenario_file_is_taken_and_an_unknown_name_refused_before_anything_is_written(tmp_path):
    shipped = resource_folder("scenarios") / "beam_horizontal_truth.toml"
    own = tmp_path / "own.toml"
    own.write_text(shipped.read_text())
    assert load_procedure("stability_map", {"scenario": str(own)}).scenario == str(own)
    out = tmp_path / "out"
    out.mkdir()
    unknown = load_procedure("stability_map", {"scenario": "beam_horizontal_trut"})
    with pytest.raises(UnknownNameError, match="did you mean 'beam_horizontal_truth'"):
        unknown.carry_out(RunContext(out))
    assert not list(out.iterdir())


def test_no_scenario_file_is_read_when_procedures_are_imported():
    code = (
        "import ves_twin.scenario.load as load;"
        "load._read = lambda path: 1 / 0;"
        "from ves_twin.procedures.registry import PROCEDURES, procedure_class;"
        "list(map(procedure_class, PROCEDURES))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
