"""The page for newcomers, followed to the letter: a model, a log, two commands."""

from __future__ import annotations

import json
import re
import runpy
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest
from sizes import nightly_but

from ves_twin.cli.main import main
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.machines.mjcf.recordings.read import read_recording
from ves_twin.machines.mjcf.rig.machine import Rig

PAGE = Path(__file__).parents[3] / "docs" / "bring-your-own-rig.md"


def blocks(kind: str) -> list[str]:
    found = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    return [text for label, text in found if label == kind]


def write_crane():
    """The model, and the machine's file as the appendix has it."""
    (model,) = blocks("xml")
    Path("crane.xml").write_text(model)
    Path("crane.toml").write_text(blocks("toml")[1])


def write_logs(log="12.0", check="10.0"):
    """The logs of the page, or shorter ones."""
    (Path("crane.xml")).write_text(blocks("xml")[0])
    made = blocks("python")[0].replace('"log.csv", 12.0', f'"log.csv", {log}')
    Path("machine.py").write_text(made.replace('"check.csv", 10.0', f'"check.csv", {check}'))
    runpy.run_path("machine.py")


def holds(level):
    """The interval is of 90 %; twice its half-width is 3.3 sigma."""
    return abs(level["value"] - 1.2) < level["high"] - level["low"]


def the_friction(folder):
    """Its level, where the verdict names it alone."""
    verdict = json.loads(Path(folder, "verdict.json").read_text())
    (cause,) = verdict["causes"]
    assert (cause["effect"], cause["target"]) == ("coulomb_friction", "rail")
    assert verdict["gain"]["low"] > 0.0
    return cause["parameters"]["level"]


def improved(before, after):
    """Whether the cart's error went down to a tenth from one comparison to the other."""
    errors = (
        json.loads(Path(folder, "compare.json").read_text())["recordings"][0]["channels"]
        for folder in (before, after)
    )
    one, two = (
        next(e for n, e in e.items() if "position" in n and "swing" not in n) for e in errors
    )
    return two["rms_slow"] < 0.1 * one["rms_slow"]


def test_the_page_shows_the_draft_that_its_first_command_writes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_logs()
    new, _ = blocks("")[0].splitlines()
    assert main(shlex.split(new)[1:]) == 0
    told = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    assert "\n".join(told).strip() == blocks("text")[0].strip()
    shown = tomllib.loads(blocks("toml")[0])
    assert shown == tomllib.loads(Path("crane.toml").read_text())


@pytest.mark.slow
@pytest.mark.parametrize(("log", "check"), nightly_but(1, [("6.0", "5.0"), ("12.0", "10.0")]))
def test_the_file_of_the_appendix_names_the_hidden_friction(tmp_path, monkeypatch, log, check):
    monkeypatch.chdir(tmp_path)
    write_logs(log, check)
    write_crane()
    plant = ["--plant", "crane.toml", "--out"]
    assert main(["compare", "log.csv", *plant, "compared"]) == 0
    held = ["--held-out", "check.csv"]
    assert main(["diagnose", "log.csv", *held, *plant, "diagnosed"]) == 0
    level = the_friction("diagnosed")
    # what was written is a rig again, and has the friction
    again = Rig.load("diagnosed/plant.toml")
    assert again.model.dof_frictionloss[0] == pytest.approx(level["value"], abs=1e-12)
    last = ["check.csv", "--plant", "diagnosed/plant.toml", "--out", "again"]
    assert main(["compare", *last]) == 0
    assert improved("compared", "again")
    assert holds(level)


@pytest.mark.nightly
def test_a_log_of_another_shape_goes_through_map_and_experiment_to_the_same_friction(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    write_crane()
    Path("bench.py").write_text(blocks("python")[1])
    runpy.run_path("bench.py")
    _, _, told, experiment = blocks("toml")
    Path("bench.map.toml").write_text(told)
    Path("bench.toml").write_text(experiment)
    direct, imported, again = blocks("")[2].splitlines()
    assert main(shlex.split(direct)[1:]) == 0
    verdict = json.loads(Path("bench/verdict.json").read_text())
    (cause,) = verdict["causes"]
    assert (cause["effect"], cause["target"]) == ("coulomb_friction", "rail")
    level = cause["parameters"]["level"]
    # the other road is the same recording to the last bit, so that its verdict is the same
    assert main(shlex.split(imported)[1:]) == 0
    assert again.replace("bench.parquet", "bench.csv --map bench.map.toml").endswith("--out again")
    machine = Rig.load("crane.toml")
    one = read_recording(Path("bench.csv"), machine, ImportMap.load("bench.map.toml"))
    two = read_recording(Path("bench.parquet"), machine)
    assert one.signals.keys() == two.signals.keys() == machine.description.signals.keys()
    assert all(np.array_equal(one[name], two[name]) for name in one.signals)
    assert np.array_equal(one.time, two.time)
    assert holds(level)
