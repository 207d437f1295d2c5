"""The page for newcomers, followed to the letter: two files, a log, two commands."""

from __future__ import annotations

import json
import re
import runpy
import shlex
from pathlib import Path

import pytest

from ves_twin.cli.main import main
from ves_twin.rigs.rig import Rig

PAGE = Path(__file__).parents[2] / "docs" / "bring-your-own-rig.md"


def blocks(kind: str) -> list[str]:
    found = re.findall(r"^```(\w*)\n(.*?)^```$", PAGE.read_text(), re.DOTALL | re.MULTILINE)
    return [text for label, text in found if label == kind]


@pytest.mark.slow
def test_the_page_names_the_hidden_friction_of_a_rig_that_is_not_ours(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (model,), (script,), (rig,) = blocks("xml"), blocks("python"), blocks("toml")
    Path("crane.xml").write_text(model)
    Path("crane.toml").write_text(rig)
    Path("machine.py").write_text(script)
    runpy.run_path("machine.py")
    commands = [line for block in blocks("") for line in block.splitlines()]
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
    # the interval is of 90 %; twice its half-width is 3.3 sigma
    assert abs(level["value"] - 1.2) < level["high"] - level["low"]
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
