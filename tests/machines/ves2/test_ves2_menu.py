"""Programmes that VES II could do next: within its limits, and written so that others can read."""

import csv

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import FileAccessError
from ves_twin.machines.ves2.excitations import MENU, offered_programmes, write_setpoints
from ves_twin.machines.ves2.forward import RigForward
from ves_twin.simulator.replay import replay_scenario


@pytest.fixture(scope="module")
def plant():
    return vt.Plant.load("ves2_pressure")


@pytest.fixture(scope="module")
def offered(plant):
    return offered_short(plant, vt.Scenario.load("identify_fast"), MENU, 6.0)


@pytest.mark.slow
def test_every_offer_keeps_stroke_speed_and_wrench_limits(offered, plant):
    number, array = plant.parameters.number, plant.parameters.array
    home = plant.geometry.lengths(np.zeros(6))
    travel = number("leg.stroke") / 2.0 - number("leg.margin")
    assert [p.name for p in offered] == list(MENU)
    for programme in offered:
        legs = programme.drive["leg.command"]
        assert np.abs(legs - home).max() <= travel
        speed = np.abs(np.diff(legs, axis=0)).max() / programme.period
        assert speed < array("hydraulics.full_speed").min()
        assert programme.time[-1] == pytest.approx(6.0, abs=0.05)


@pytest.mark.slow
def test_an_offer_can_be_predicted_by_the_rig_of_the_recording(offered, plant):
    scenario = vt.Scenario.load("identify_fast", {"run.duration": 2.0, "run.settle": 0.3})
    forward = RigForward(plant, replay_scenario(vt.simulate(scenario, plant=plant)))
    rows = forward.simulate(offered[0], {})
    names = [channel.name for channel in forward.channels]
    wrench = rows[:, names.index("sensor.wrench.1") : names.index("sensor.wrench.6") + 1]
    assert np.all(np.abs(wrench).max(axis=0) < plant.parameters.array("sensor.range"))
    gap = rows[:, :6] - offered[0].drive["leg.command"]
    # the legs follow with the lag of their gain, 12.6 /s: speed over gain, and a little more
    speed = np.abs(np.diff(offered[0].drive["leg.command"], axis=0)).max() / offered[0].period
    assert np.abs(gap[50:]).max() < 1.2 * speed / scenario.legs.gain


def test_set_points_are_plain_csv(plant, tmp_path):
    scenario = vt.Scenario.load("identify_slow")
    short = {"only": ("identify_slow", {"run.settle": 0.2})}
    programmes = offered_short(plant, scenario, short)
    path = tmp_path / "next_experiment.csv"
    write_setpoints(programmes[0], path)
    with path.open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["t", *(f"leg.command.{i}" for i in range(1, 7)), *ARM]
    read = np.array([[float(row[f"leg.command.{i}"]) for i in range(1, 7)] for row in rows])
    assert read == pytest.approx(programmes[0].drive["leg.command"], abs=1e-9)
    with pytest.raises(FileAccessError, match="cannot write"):
        write_setpoints(programmes[0], tmp_path / "no" / "next.csv")


ARM = ("arm.command.1", "arm.command.2", "arm.command.3")


def offered_short(plant, scenario, menu, seconds=1.5):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ves_twin.machines.ves2.excitations.MENU", menu)
        patch.setattr("ves_twin.machines.ves2.excitations.SECONDS", seconds)
        return offered_programmes(plant, scenario)


def test_what_is_too_fast_is_not_offered(plant):
    slow = plant.with_values({"hydraulics.full_speed": 1e-4})
    scenario = vt.Scenario.load("identify_fast")
    assert offered_short(slow, scenario, {"fast": ("identify_fast", {})}) == ()
