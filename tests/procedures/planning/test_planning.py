"""The procedures of chapter 4 in zero gravity, as shipped and by the command line."""

import csv
import json

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import VesTwinError
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure
from ves_twin.simulator.zero_gravity import zero_gravity_motion

NONLINEAR = 0.03
"""Relative: the arm turns base axes by 10 mrad and, at a corner, lags its commands by 3 deg."""


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    folder = tmp_path_factory.mktemp("paths")
    procedure = load_procedure("coupling_map_paths", {"on_rig": False})
    return folder, procedure.carry_out(RunContext(folder))


@pytest.fixture(scope="module")
def release(tmp_path_factory):
    folder = tmp_path_factory.mktemp("release")
    return folder, load_procedure("pped_release").carry_out(RunContext(folder))


def table(path):
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], np.array(rows[1:], float)


def test_the_good_path_transfers_less_than_half_the_energy_of_the_bad_one(paths, figure):
    """C057."""
    values = paths[1].values["zero_g"]
    figure(
        "zero-g: peak energy of the good path over the bad one", values["good_over_bad"], 0.5, ""
    )
    assert values["good_over_straight"] < 1.0
    assert values["good"]["coupling_length"] < values["straight"]["coupling_length"]


def test_linear_and_nonlinear_energies_agree(paths):
    for name in ("good", "straight", "bad"):
        values = paths[1].values["zero_g"][name]
        np.testing.assert_allclose(
            values["peak_energy"], values["peak_energy_linear"], rtol=NONLINEAR
        )


def test_the_written_paths_go_from_start_to_end(paths):
    head, rows = table(paths[0] / "paths.csv")
    assert head[:2] == ["t [s]", "good.q.1 [rad]"]
    np.testing.assert_allclose(np.diff(rows[:, 0]), 1 / 80, rtol=0, atol=1e-6)
    for name in ("good", "straight", "bad"):
        q = rows[:, head.index(f"{name}.q.1 [rad]") :][:, :3]
        np.testing.assert_allclose(q[0], [0.0, np.pi / 2, 0.0], rtol=0, atol=1e-8)
        np.testing.assert_allclose(q[-1], [np.pi / 2, 0.0, 0.0], rtol=0, atol=1e-8)
        peak = rows[:, head.index(f"{name}.energy [J]")].max()
        np.testing.assert_allclose(peak, paths[1].values["zero_g"][name]["peak_energy"], rtol=1e-8)


def test_release_has_the_integrals_of_the_thesis_gains(release):
    """C071; 0.5 % is asked."""
    values = release[1].values["zero_g"]
    np.testing.assert_allclose(values["pped"]["energy_integral"], 18.65, rtol=0.005)
    np.testing.assert_allclose(values["high"]["energy_integral"], 20.58, rtol=0.005)
    times = [values[name]["last_time_above_10_percent"] for name in ("pped", "high")]
    np.testing.assert_allclose(times, [7.8, 8.7], rtol=0, atol=0.05)


def test_found_gains_beat_the_thesis_by_25_percent_also_in_the_nonlinear_simulation(
    release, figure
):
    values = release[1].values["zero_g"]
    for key in ("energy_integral", "energy_integral_nonlinear"):
        share = values["energy"][key] / values["pped"][key]
        figure(f"zero-g release: {key} of the found gains over PPED", 100 * share, 75.0, "%")


@pytest.mark.parametrize("name", ["pped", "high", "estimator", "energy"])
def test_the_nonlinear_release_is_what_the_linear_dynamics_say(release, name):
    """Joints move by 11 deg at most, the base by 0.2 m."""
    values = release[1].values["zero_g"][name]
    np.testing.assert_allclose(
        values["energy_integral_nonlinear"], values["energy_integral_split_inertias"], rtol=0.005
    )


def test_the_written_release_holds_every_gain_set(release):
    head, rows = table(release[0] / "release.csv")
    assert len(head) == 1 + 3 * 4
    np.testing.assert_allclose(rows[0, 1], np.sqrt(0.03), rtol=1e-6)
    energy = rows[:, head.index("pped.energy [J]")]
    np.testing.assert_allclose(energy[0], 7.6, rtol=1e-6)


def test_procedures_run_from_the_command_line(tmp_path, capsys):
    out = tmp_path / "out"
    changes = ["--set", "rest=1.0", "--set", "on_rig=false"]
    assert main(["run", "coupling_map_paths", *changes, "--out", str(out), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["outcome"] == "completed"
    assert summary["zero_g"]["good_over_bad"] < 0.5
    assert (out / "paths.csv").is_file()


@pytest.mark.parametrize(
    ("name", "changes", "words"),
    [
        ("coupling_map_paths", {"emulated": "beam_bend_thesis"}, ["emulated", "beam_bent_thesis"]),
        ("coupling_map_paths", {"start": ["0 deg", "120 deg", 0.0]}, ["path start", "105"]),
        ("coupling_map_paths", {"duration": 0.0}, ["duration", "greater than 0"]),
        ("coupling_map_paths", {"corners": []}, ["corners", "1 item"]),
        ("pped_release", {"smallest_gain": 2e4}, ["bounds"]),
        ("pped_release", {"start": [0.1]}, ["start", "6 numbers"]),
        ("pped_release", {"frictoin": True}, ["'friction'"]),
    ],
)
def test_wrong_options_are_refused_in_one_line(tmp_path, name, changes, words):
    with pytest.raises(VesTwinError) as caught:
        load_procedure(name, changes).carry_out(RunContext(tmp_path))
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_zero_gravity_commands_of_another_shape_are_refused():
    plant, base = vt.Plant.load("ves2"), EmulatedSystem.load("table_5_2")
    with pytest.raises(VesTwinError, match="rows of 3"):
        zero_gravity_motion(plant, base, np.zeros((5, 2)), 0.0125)
