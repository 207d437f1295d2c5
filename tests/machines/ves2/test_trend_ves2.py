"""VES II over days, as any machine: a valve's null that came between two recordings."""

import json

import pytest

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.recording.files import save_recording

NULLS = {"2026-03-02": 0.0, "2026-03-05": 0.0, "2026-03-09": 0.01, "2026-03-12": 0.01}


@pytest.mark.nightly
@pytest.mark.timeout(900)  # 800 simulations of 3 s, several minutes on a busy machine
def test_a_null_that_came_is_named_dated_and_sized(tmp_path, capsys):
    short = {"run.duration": 3.0, "plant": "ves2_fast"}
    scenario = vt.Scenario.load("identify_fast", short)
    (tmp_path / "days").mkdir()
    for seed, (date, null) in enumerate(NULLS.items(), 10):
        plant = vt.Plant.load("ves2_fast")
        if null:
            plant = plant.extended(vt.effects.ValveNull("leg.3", null=null))
        run = vt.simulate(scenario, plant=plant, seed=seed)
        save_recording(run, tmp_path / "days" / f"{date}.parquet")
    words = ["trend", str(tmp_path / "days"), "--plant", "ves2_fast", "--json"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["cause"]["effect"], said["cause"]["target"]) == ("valve_null", "leg.3")
    assert said["answer"] == "step"
    assert said["change"]["onset_date"]["value"] == "2026-03-09"
    after = said["change"]["after"]
    # the interval is of 90 %; twice its half-width is 3.3 sigma
    assert abs(after["value"] - 0.01) < after["high"] - after["low"]
