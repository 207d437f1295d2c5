"""Laws in the compiled loop of VES II: as the rig's own physics where that has them, and in files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import ves_twin as vt
from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.effects.law import LawKind, LawShape
from ves_twin.effects.law_table import LawTable
from ves_twin.effects.registry import build_effect
from ves_twin.plant.mjcf_export import mjcf_of
from ves_twin.plant.write_plant import write_plant
from ves_twin.simulator.simulator import Simulator

FAST = vt.Plant.load("ves2_fast")
SCENARIO = vt.Scenario.load(
    "identify_fast", {"plant": "ves2_fast", "run.duration": 4.0, "run.noise": False}
)

EXPLICIT = 0.002
"""Share of a damping's own change that its effort makes when it is held over a step of 0.34 ms."""

ENCODER = 1.01e-4
"""A count of the arm's encoders [rad], and round-off."""


def law(place: str, of: str, low: float, high: float, reach: float = 1.0, **more) -> LawTable:
    told = {"kind": LawKind.EFFORT, "knots": ((-reach, reach),), **more}
    return LawTable(place=place, of=(of,), values=(low, high), **told)


def run(*laws: LawTable, plant: vt.Plant = FAST) -> vt.Recording:
    return vt.simulate(SCENARIO, plant.with_laws(*laws))


@pytest.fixture(scope="module")
def plain() -> vt.Recording:
    return run()


def test_a_law_proportional_to_a_joints_speed_is_its_damping(plain):
    damped = run(plant=FAST.extended(build_effect("viscous_friction", "arm.q2", {"damping": 8.0})))
    lawful = run(law("arm.q2", "speed@arm.q2", 80.0, -80.0, 10.0))
    change = np.abs(damped["arm.torque"] - plain["arm.torque"]).max()
    assert change > 3.0  # N m
    assert np.abs(lawful["arm.torque"] - damped["arm.torque"]).max() < EXPLICIT * change


@pytest.mark.parametrize("name", ["ves2_fast", "ves2"])
def test_a_law_proportional_to_a_rods_speed_is_less_damping_of_the_oil(name):
    """The cylinder pushes with k (x - q) - c q': the law gives back a tenth of c."""
    plant = vt.Plant.load(name)
    (damping,) = set(plant.parameters.array("hydraulics.oil_damping"))
    less = np.full(6, damping)
    less[2] *= 0.9
    softer = run(plant=plant.with_values({"hydraulics.oil_damping": less}))
    lawful = run(law("leg.3", "speed@leg.3", -0.1 * damping, 0.1 * damping), plant=plant)
    before = run(plant=plant)
    change = np.abs(softer["truth.pose"] - before["truth.pose"]).max()
    assert np.abs(lawful["truth.pose"] - softer["truth.pose"]).max() < 0.05 * change


def test_a_constant_force_on_the_platform_is_carried_by_the_legs(plain):
    pushed = run(law("platform.z", "time", 500.0, 500.0))
    more = (pushed["truth.leg_force"] - plain["truth.leg_force"])[-1]
    top, base = FAST.geometry.top, FAST.geometry.base
    up = (top + FAST.geometry.home - base)[:, 2] / FAST.geometry.lengths(np.zeros(6))
    assert_allclose(more @ up, -500.0, rtol=0.05)


def test_a_law_of_a_reading_moves_its_column_alone(plain):
    read = run(law("arm.q.2", "time", 0.0, 0.4, 40.0, kind=LawKind.READING))
    added = read["arm.q"][:, 1] - plain["arm.q"][:, 1]
    assert_allclose(added, 0.2 + 0.005 * plain.time, atol=1e-9)
    assert all(np.array_equal(read[name], plain[name]) for name in plain.signals if name != "arm.q")


def test_a_law_of_the_force_sensor_moves_an_emulation_too():
    """The admittance loop is told what the sensor reads."""
    scenario = vt.Scenario.load("free_float", {"run.duration": 1.0, "run.noise": False})
    plant = vt.Plant.load(scenario.plant)
    pushing = law("sensor.wrench.3", "time", 30.0, 30.0, kind=LawKind.READING)
    before, after = (vt.simulate(scenario, p) for p in (plant, plant.with_laws(pushing)))
    assert np.abs(after["truth.pose"] - before["truth.pose"])[-1, 2] > 1e-4


def test_readings_are_held_and_follow_a_play(plain):
    kind = {"kind": LawKind.READING}
    held = LawTable(place="arm.torque.1", shape=LawShape.HOLD, values=(5.0,), **kind)
    slack = LawTable(place="arm.q.1", shape=LawShape.PLAY, values=(0.1,), **kind)
    read = run(held, slack)
    torque = read["arm.torque"][:, 0]
    assert np.array_equal(torque, plain["arm.torque"][np.arange(len(torque)) // 5 * 5, 0])
    behind = plain["arm.q"][:, 0] - read["arm.q"][:, 0]
    assert_allclose([behind.min(), behind.max()], [0.0, 0.05], atol=ENCODER)


def test_a_run_with_laws_repeats_from_a_snapshot():
    """A place within a play remembers where its slider is."""
    slack = law("arm.q2", "position@arm.q2 within 0.2", 40.0, -40.0)
    sim = Simulator(FAST.with_laws(slack), SCENARIO)
    sim.advance(2.0)
    kept = sim.snapshot()
    ends = []
    for _ in range(2):
        sim.restore(kept)
        sim.advance(1.0)
        ends.append(sim.data.qpos.copy())
    assert np.array_equal(*ends)


def test_a_run_says_where_a_law_is_held():
    inside, beyond = (law("arm.q2", "speed@arm.q2", 1.0, -1.0, reach) for reach in (9.0, 0.2))
    words = [e.message for e in run(beyond).info.events if e.kind == "law_held"]
    assert "arm.q2(speed@arm.q2) is held in" in words[0]
    assert not [e for e in run(inside).info.events if e.kind == "law_held"]


def test_a_file_with_a_law_loads_and_runs_as_it_was_written(tmp_path: Path):
    first = law("arm.q2", "speed@arm.q2", 9.0, -9.0, 2.0, form="-4.5 x", seen=((-1.0, 1.0),))
    plant, path = FAST.with_laws(first), tmp_path / "plant.toml"
    write_plant(plant, path)
    again = vt.Plant.load(str(path))
    assert again.told_laws == (first,)
    assert again.hash == plant.hash != FAST.hash
    over = tmp_path / "over.toml"
    write_plant(plant.with_laws(law("arm.q2", "speed@arm.q2", 8.0, -8.0)), over)
    text = over.read_text().replace('base = "ves2_fast"', f'base = "{path}"')
    over.write_text(text)
    assert [told.values for told in vt.Plant.load(str(over)).told_laws] == [(8.0, -8.0)]


def test_a_law_that_is_a_cause_does_not_act(plain):
    cause = law("arm.q2", "speed@arm.q2", 9.0, -9.0, cause=True)
    assert np.array_equal(run(cause)["arm.torque"], plain["arm.torque"])
    assert FAST.with_laws(cause).hash == FAST.hash


def test_a_law_is_among_what_mjcf_cannot_carry():
    export = mjcf_of(FAST.with_laws(law("leg.1", "speed@leg.1", 9.0, -9.0)))
    assert export.lost == ("law leg.1(speed@leg.1)",)


@pytest.mark.parametrize(
    ("line", "error", "said"),
    [
        ('place = "leg.7"', UnknownNameError, "leg.6"),
        ('of = ["sped@arm.q2"]', UnknownNameError, "speed@arm.q2"),
        ('of = ["command@platform.x"]', UnknownNameError, "variable"),
        ("knots = [[1.0, 0.0]]", InvalidInputError, "rising"),
        ("values = [1.0]", InvalidInputError, "expected 2"),
        ('shape = "stop"', InvalidInputError, "stop"),
        ("vaules = [1.0]", UnknownNameError, "values"),
    ],
)
def test_a_law_that_fits_no_place_is_refused_in_one_line(
    tmp_path: Path, capsys, line: str, error: type[VesTwinError], said: str
):
    key = line.split(" =", maxsplit=1)[0]
    entry = {
        "place": '"arm.q2"',
        "kind": '"effort"',
        "of": '["speed@arm.q2"]',
        "knots": "[[-1.0, 1.0]]",
        "values": "[1.0, -1.0]",
    }
    lines = [f"{name} = {value}" for name, value in entry.items() if name != key]
    path = tmp_path / "odd.toml"
    path.write_text("\n".join(['schema = 1\nbase = "ves2"\n[[laws]]', *lines, line]))
    with pytest.raises(error, match=said):
        vt.Plant.load(str(path))
    assert main(["run", "identify_fast", "--set", f"plant={path}", "--out", str(tmp_path)]) != 0
    told = capsys.readouterr().err.strip()
    assert said in told
    assert "\n" not in told
