"""A crank that pushes a piston: loops close from the first row, and a draft lets the drive move."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from ves_twin.machines.compare import compare
from ves_twin.machines.load import open_machine
from ves_twin.machines.mjcf.draft.closed_chain import closed_chain
from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.draft.home_of import home_of
from ves_twin.machines.mjcf.draft.log_columns import LogColumns
from ves_twin.machines.mjcf.draft.match import Match
from ves_twin.machines.mjcf.draft.spots import Quantity, Spot
from ves_twin.machines.mjcf.parts.loops import CLOSED, assemble, dense_copy, loop_rows
from ves_twin.report.comparison.words import fed_words

CRANK, ROD, HOME, MASS = 0.1, 0.3, np.pi / 3.0, 2.0
"""Lengths [m], the crank's angle in the model [rad], the piston's mass [kg]."""


def place(angle: float) -> float:
    """Of the piston: x = a cos t + sqrt(l^2 - a^2 sin^2 t)."""
    return float(CRANK * np.cos(angle) + np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2))


def ratio(angle: float) -> float:
    """dx/dt: -a sin t - a^2 sin t cos t / sqrt(l^2 - a^2 sin^2 t)."""
    s, c = np.sin(angle), np.cos(angle)
    return float(-CRANK * s - CRANK**2 * s * c / np.sqrt(ROD**2 - (CRANK * s) ** 2))


def text(motor: str) -> str:
    """The machine at HOME with a motor at one of its joints; crank and rod weigh next to nothing."""
    x, z, end = CRANK * np.cos(HOME), CRANK * np.sin(HOME), place(HOME)
    light = '<inertial pos="0 0 0" mass="0.005" diaginertia="1e-5 1e-5 1e-5"/>'
    return f"""
<mujoco model="press">
  <option timestep="0.0005" gravity="0 0 0" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="crank"><joint name="crank" axis="0 -1 0"/>{light}
      <body name="rod" pos="{x} 0 {z}"><joint name="rod" axis="0 -1 0"/>{light}</body></body>
    <body name="piston" pos="{end} 0 0"><joint name="piston" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="{MASS}" diaginertia="1 1 1"/></body>
  </worldbody>
  <equality><connect body1="piston" body2="rod" anchor="0 0 0" solref="0.002 1"/></equality>
  <actuator><motor name="drive" joint="{motor}"/></actuator>
</mujoco>"""


def model(motor: str = "crank") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(text(motor))


def test_a_drive_feels_what_its_loop_carries():
    """The crank feels m (dx/dt)^2, the piston its own mass; crank and rod weigh half a percent."""
    felt = closed_chain(model(), ["crank"])["crank"]
    assert felt == pytest.approx(MASS * ratio(HOME) ** 2, rel=5e-3)
    assert closed_chain(model(), ["piston"])["piston"] == pytest.approx(MASS, rel=5e-3)


def test_drives_that_leave_a_motion_free_are_no_parallel_machine():
    assert not closed_chain(model(), [])
    open_chain = text("crank").replace("<connect", "<!--").replace('solref="0.002 1"/>', "-->")
    assert not closed_chain(mujoco.MjModel.from_xml_string(open_chain), ["crank"])
    loose = text("crank").replace(
        "</worldbody>",
        '<body name="free"><freejoint/><geom size="1" mass="1"/></body></worldbody>',
    )
    assert not closed_chain(mujoco.MjModel.from_xml_string(loose), ["crank"])


@pytest.mark.parametrize("turn", [-0.4, 0.3, 0.9])
def test_loops_close_about_a_joint_that_is_told_in_place_and_speed(turn):
    machine = model()
    data = mujoco.MjData(machine)
    crank, piston = (machine.joint(name) for name in ("crank", "piston"))
    data.qpos[crank.qposadr[0]], data.qvel[crank.dofadr[0]] = turn, 2.0
    assemble(machine, data, np.array([crank.dofadr[0]]))
    assert data.qpos[crank.qposadr[0]] == turn
    moved = place(HOME + turn) - place(HOME)
    assert data.qpos[piston.qposadr[0]] == pytest.approx(moved, abs=CLOSED)
    assert data.qvel[piston.dofadr[0]] == pytest.approx(2.0 * ratio(HOME + turn), rel=1e-6)
    look = mujoco.MjData(dense_copy(machine))
    look.qpos[:] = data.qpos
    gaps, rows = loop_rows(dense_copy(machine), look)
    assert np.max(np.abs(gaps)) < CLOSED
    assert np.max(np.abs(rows @ data.qvel)) < 1e-9


def test_loops_that_cannot_close_stay_as_they_are():
    machine = model()
    data = mujoco.MjData(machine)
    piston = machine.joint("piston")
    data.qpos[piston.qposadr[0]] = 1.0  # a metre off, where crank and rod reach 0.4
    before = data.qpos.copy()
    assemble(machine, data, np.array([piston.dofadr[0]]))
    assert np.array_equal(data.qpos, before)


def logged(folder, home: float):
    """The piston shaken by hand, its length told from somewhere."""
    rng = np.random.default_rng(2)
    time = 0.005 * np.arange(2400)
    x = 0.012 * np.sin(2.0 * np.pi * np.outer(time, [0.7, 1.9]) + 0.8).sum(axis=1)
    force = MASS * np.gradient(np.gradient(x, 0.005), 0.005)
    length = 1e3 * (home + x + 2e-6 * rng.standard_normal(len(time)))
    rows = np.column_stack([time, length, force + 0.02 * rng.standard_normal(len(time))])
    path = folder / "log.csv"
    np.savetxt(
        path, rows, "%.6f", ",", header="t [s],piston length [mm],drive force [N]", comments=""
    )
    (folder / "press.xml").write_text(text("piston"))
    return path


@pytest.mark.parametrize(
    ("home", "why"),
    [(0.0, ""), (place(HOME), "the length that the model has"), (1.7, "as if the log began")],
    ids=["zero", "length", "elsewhere"],
)
def test_a_draft_lets_the_drives_of_a_parallel_machine_move_and_compares_their_efforts(
    tmp_path, home, why
):
    log = logged(tmp_path, home)
    found = draft(tmp_path / "press.xml", [log], tmp_path / "my.toml")
    told = tomllib.loads(found.text)
    assert told["drive"]["mode"] == "control"
    assert told["drive"]["imposed"] == ["piston"]
    assert told["compare"] == {"drive.effort": {"actuator": "drive"}}
    assert why in found.text
    length = told["signals"]["piston.position"]
    if home < 1.0:  # what the model says; else where the log begins
        assert length.get("offset", 0.0) == pytest.approx(-1e3 * home, abs=1e-3)
    assert found.explained["drive.effort"] > 0.98
    (tmp_path / "my.toml").write_text(found.text)
    machine = open_machine(str(tmp_path / "my.toml"))
    (one,) = compare([machine.read(str(log))], machine, patience=0.0).recordings
    assert fed_words(one) == "piston moved as recorded, all else integrated"


@pytest.mark.parametrize("scale", [1.0, -1.0])
def test_what_makes_a_length_a_position_is_told_in_its_unit_whatever_its_sign(tmp_path, scale):
    """Of a piston whose length counts the other way, in mm: scale times column plus offset."""
    logged(tmp_path, place(HOME))
    log = LogColumns.read(tmp_path / "log.csv")
    values = {name: scale * column for name, column in log.values.items()}
    spot = Spot(Quantity.POSITION, "piston", "m", frozenset(), 1)
    match = Match("piston length", spot, "mm", True, scale, ())
    name = next(column for column in values if column.startswith(match.column))
    match = replace(match, column=name)
    offset, _ = home_of(match, model("piston"), replace(log, values=values))
    begun = scale * values[name][0] + offset
    assert abs(begun) < 30.0  # within the piston's motion of home, not two lengths away
    assert offset == pytest.approx(-1e3 * place(HOME), abs=1e-3)
