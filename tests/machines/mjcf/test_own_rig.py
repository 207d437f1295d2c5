"""The page for newcomers, followed to the letter: two files, a log, two commands."""

from __future__ import annotations

import json
import re
import runpy
import shlex
from pathlib import Path

import numpy as np
import pytest

from ves_twin.cli.main import main
from ves_twin.data.import_map import ImportMap
from ves_twin.machines.mjcf.machine import Rig
from ves_twin.machines.mjcf.read import read_recording

PAGE = Path(__file__).parents[3] / "docs" / "bring-your-own-rig.md"


def blocks(kind: str) -> list[str]:
    found = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    return [text for label, text in found if label == kind]


def write_crane():
    (model,) = blocks("xml")
    Path("crane.xml").write_text(model)
    Path("crane.toml").write_text(blocks("toml")[0])


def holds(level):
    """The interval is of 90 %; twice its half-width is 3.3 sigma."""
    return abs(level["value"] - 1.2) < level["high"] - level["low"]


@pytest.mark.slow
def test_the_page_names_the_hidden_friction_of_a_rig_that_is_not_ours(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_crane()
    Path("machine.py").write_text(blocks("python")[0])
    runpy.run_path("machine.py")
    commands = [line for block in blocks("")[:2] for line in block.splitlines()]
    assert len(commands) == 3
    for command in commands:
        assert main(shlex.split(command)[1:]) == 0
    verdict = json.loads(Path("diagnosed/verdict.json").read_text())
    (cause,) = verdict["causes"]
    assert (verdict["verdict"], cause["effect"], cause["target"]) == (
        "named",
        "coulomb_friction",
        "rail",
    )
    level = cause["parameters"]["level"]
    assert verdict["gain"]["low"] > 0.0
    # what was written is a rig again, and has the friction
    again = Rig.load("diagnosed/plant.toml")
    assert again.model.dof_frictionloss[0] == pytest.approx(level["value"], abs=1e-12)
    before, after = (
        json.loads(Path(folder, "compare.json").read_text())["recordings"][0]["channels"]
        for folder in ("compared", "again")
    )
    cart = "cart.position"
    assert after[cart]["rms_slow"] < 0.1 * before[cart]["rms_slow"]
    assert holds(level)


@pytest.mark.nightly
def test_a_log_of_another_shape_goes_through_map_and_experiment_to_the_same_friction(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    write_crane()
    Path("bench.py").write_text(blocks("python")[1])
    runpy.run_path("bench.py")
    _, told, experiment = blocks("toml")
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
