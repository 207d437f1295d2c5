"""A calibration moves a plant back into its claims, and says what it cannot."""

import json

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.effects import CoulombFriction
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure
from ves_twin.procedures.stability.calibration_files import Fit, write_fit
from ves_twin.procedures.stability.feasible import Feasible

SHORT = {
    "claims": [
        {"name": "mode_highest", "high": 13.2, "scale": 0.3},
        {"name": "mode_lowest", "low": 10.0, "scale": 0.3},
        {"name": "bandwidth_low", "low": 2.0, "high": 2.4, "scale": 0.1},
    ],
    "knobs": [
        {"name": "leg.bending_stiffness", "low": 1000.0, "high": 2500.0},
        {"name": "gain.low", "low": 8.0, "high": 18.0},
    ],
    "rounds": 2, "reach": 0.4, "verify": False, "workers": 1,
}  # fmt: skip


@pytest.mark.slow
def test_fit_brings_a_plant_back_into_its_claims(tmp_path):
    """Legs a third too stiff and a gain a third too high; two claims know one number each."""
    off = vt.Plant.load("ves2").with_values({"leg.bending_stiffness": 2000.0})
    procedure = load_procedure("calibrate_plant", SHORT | {"gains.low": 16.5})
    procedure.carry_out(RunContext(tmp_path, plant=off))
    result = json.loads((tmp_path / "calibration.json").read_text())
    assert result["worst_margin_of_each_round"][0] < 0.0 < result["worst_margin_of_each_round"][-1]
    assert 11.0 < result["numbers"]["gain.low"]["value"] < 14.0
    # gain and structure have no claim in common
    assert result["sensitivities"]["bandwidth_low >="]["leg.bending_stiffness"] == 0.0
    fitted = vt.Plant.load(str(tmp_path / "plant.toml"))
    stiffness = result["numbers"]["leg.bending_stiffness"]["value"]
    assert fitted.parameters.number("leg.bending_stiffness") == pytest.approx(stiffness, rel=1e-3)
    assert 'grade = "calibrated"' in (tmp_path / "entries.toml").read_text()


def test_the_written_plant_keeps_effects_and_what_else_differed(tmp_path):
    start = vt.Plant.load("ves2").with_values({"leg.rod_mass": 2.7})
    start = start.extended(CoulombFriction("leg.3", level=60.0))
    fit = Fit(
        plant=start,
        names=("leg.bending_stiffness", "gain.low"),
        start=np.array([1500.0, 12.6]),
        values=np.array([1234.56, 12.0]),
        spread=np.array([100.0, np.nan]),
        claims={"mode_lowest": 11.0},
        region=Feasible(("mode_lowest >=",), np.array([1.0]), np.array([[0.5, 0.0]])),
        history=(1.0,),
        at_ends={},
    )
    write_fit(fit, {"mode_lowest": "10 ..."}, tmp_path)
    written = vt.Plant.load(str(tmp_path / "plant.toml"))
    assert written.name == "ves2_calibrated"
    assert written.hash == start.with_values({"leg.bending_stiffness": 1235.0}).hash


@pytest.mark.parametrize("name", ["calibrate_plant", "calibrate_plant_pressure"])
def test_shipped_files_name_numbers_and_claims_that_exist(name, tmp_path, monkeypatch):
    """Everything up to the first measurement, for which there is no time here."""

    class ReachedError(Exception):
        pass

    def stop(*arguments):
        raise ReachedError

    procedure = load_procedure(name, {"workers": 1})
    monkeypatch.setattr("ves_twin.procedures.stability.calibrate_plant.measure_claims", stop)
    with pytest.raises(ReachedError):
        procedure.carry_out(RunContext(tmp_path))


def test_start_outside_its_range_is_refused(tmp_path):
    procedure = load_procedure("calibrate_plant", SHORT | {"gains.low": 30.0})
    with pytest.raises(InvalidInputError, match=r"gain\.low: got 30"):
        procedure.carry_out(RunContext(tmp_path))


def test_unknown_number_and_claim_are_answered_with_the_nearest(tmp_path):
    knobs = [{"name": "leg.bending_stiffnes", "low": 1.0, "high": 2.0}]
    with pytest.raises(UnknownNameError, match=r"did you mean 'leg\.bending_stiffness'"):
        load_procedure("calibrate_plant", SHORT | {"knobs": knobs}).carry_out(RunContext(tmp_path))
    claims = [{"name": "mode_lowst", "low": 1.0, "scale": 1.0}]
    with pytest.raises(VesTwinError, match="did you mean 'mode_lowest'"):
        load_procedure("calibrate_plant", SHORT | {"claims": claims})
    claims = [{"name": "mode_lowest", "scale": 1.0}]
    with pytest.raises(VesTwinError, match="neither low nor high"):
        load_procedure("calibrate_plant", SHORT | {"claims": claims})
