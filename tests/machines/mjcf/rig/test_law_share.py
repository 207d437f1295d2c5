"""What of a law over a joint's speed an MJCF file has: friction loss and damping."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
import two_link

from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.law_share import carried_of
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.mjcf_export import mjcf_of

SHAFT = """<mujoco><worldbody><body><joint name="shaft" axis="0 0 1" damping="0.01"/>
<geom size="0.1" mass="1"/></body></worldbody></mujoco>"""


def law(effort, of: str = "speed@shaft", place: str = "shaft", low: float = -5.0) -> Law:
    """A table of an effort over a speed from a lowest one to 5 rad/s."""
    knots = np.linspace(low, 5.0, 801)
    values = tuple(effort(knots).tolist())
    return Law(place, LawKind.EFFORT, LawShape.TABLE, (of,), (tuple(knots.tolist()),), values)


@pytest.fixture
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(SHAFT)


def test_dry_and_viscous_friction_are_carried_whole(model):
    found = carried_of(law(lambda v: -0.3 * np.sign(v) - 0.02 * v), model)
    assert found is not None
    assert found.friction_loss == pytest.approx(0.3, rel=1e-6)
    assert found.damping == pytest.approx(0.02, rel=1e-6)
    assert found.left < 1e-6
    assert found.words(model) == (
        "frictionloss 0 -> 0.3 N*m, damping 0.01 -> 0.03 N*m*s/rad of joint shaft,"
        " seen from -5 to 5 rad/s"
    )
    found.edit(model)
    assert model.dof_frictionloss[0] == pytest.approx(0.3)
    assert model.dof_damping[0] == pytest.approx(0.03)


def test_a_model_that_is_driven_by_its_damping_is_not_mended_by_a_law(model):
    model.dof_damping[0] = -0.02
    found = carried_of(law(lambda v: -0.3 * np.sign(v)), model)
    assert found is not None
    assert found.friction_loss == pytest.approx(0.3, rel=1e-6)
    assert found.damping == pytest.approx(0.0, abs=1e-6)
    assert found.words(model) == "frictionloss 0 -> 0.3 N*m of joint shaft, seen from -5 to 5 rad/s"


def test_what_friction_is_not_is_told_as_a_share(model):
    """-sign(v) - 0.25 |v| / 5: a mean square of 0.25^2 / 3 beside 1."""
    found = carried_of(law(lambda v: -np.sign(v) - 0.05 * np.abs(v)), model)
    assert found is not None
    assert found.friction_loss == pytest.approx(1.0, rel=1e-4)
    share = 0.25**2 / 3.0
    assert found.left == pytest.approx(np.sqrt(share / (1.0 + share)), rel=0.02)


def test_a_law_that_pushes_leaves_a_joint_with_no_less_than_no_friction(model):
    found = carried_of(law(lambda v: 0.02 * v - 0.3 * np.sign(v)), model)
    assert found is not None
    assert found.damping == pytest.approx(-0.01, rel=1e-9)
    gentle = carried_of(law(lambda v: 0.004 * v), model)
    assert gentle is not None
    assert gentle.damping == pytest.approx(-0.004, rel=1e-6)


@pytest.mark.parametrize(
    "other",
    [
        law(np.sin, of="position@shaft"),
        law(lambda v: v**2),
        law(lambda v: 0.3 * np.sign(v)),
        law(lambda v: -0.3 * np.sign(v), low=-0.2),
        law(lambda v: 0.0 * v),
        law(np.sign, of="speed@shaft + arm", place="shaft + arm"),
        replace(law(np.sign), kind=LawKind.READING),
    ],
    ids=[
        "of the place",
        "even",
        "along motion",
        "one way alone",
        "none",
        "of two joints",
        "of a reading",
    ],
)
def test_what_friction_does_not_do_is_not_carried(other, model):
    assert carried_of(other, model) is None


def test_the_exported_model_moves_as_the_machine_with_the_law_does(tmp_path: Path):
    nominal = two_link.rig(tmp_path)
    joint = nominal.model.joint(0).name
    own = law(lambda v: -0.2 * np.sign(v) - 0.1 * v, of=f"speed@{joint}", place=joint, low=-5.0)
    fed = two_link.programme()
    forward = MjcfForward.of(nominal, Mode.CONTROL)
    with_law, without = forward.simulate(fed, {}, laws=[own]), forward.simulate(fed, {})
    told = nominal.description
    table = LawTable(
        place=own.place, kind=own.kind, shape=own.shape, of=own.of, knots=own.knots,
        values=own.values, form="", seen=((-5.0, 5.0),), source="test",
    )  # fmt: skip
    machine = Rig(told.model_copy(update={"laws": (table,)}), tmp_path)
    export = mjcf_of(machine, tmp_path)
    (tmp_path / "exported.xml").write_text(export.text)
    plain = told.model_copy(update={"model": "exported.xml", "parameters": ()})
    there = MjcfForward.of(Rig(plain, tmp_path), Mode.CONTROL).simulate(fed, {})
    off, moved = (np.sqrt(np.mean(np.square(x - with_law), axis=0)) for x in (there, without))
    assert np.all(off < 0.03 * moved + 1e-9)  # a table's sign has the width of a knot, and creeps
    assert export.lost == ()
    assert any(text.startswith(f"of law {joint}(speed@{joint})") for text in export.carried)
