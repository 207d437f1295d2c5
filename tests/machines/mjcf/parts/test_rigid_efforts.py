"""Efforts that are summed from directions are those that MuJoCo's inverse dynamics gives."""

import copy

import mujoco
import numpy as np
import pytest

from ves_twin.machines.mjcf.parts import rigid_efforts
from ves_twin.machines.mjcf.parts.inertials import inertials, set_inertials, with_inertials_of
from ves_twin.machines.mjcf.parts.rigid_efforts import RigidEfforts, inverted

ARM = """<mujoco>
  <option gravity="1 2 -9.81"/>
  <worldbody>
    {floor}
    <body name="base" pos="0 0 1">
      <joint name="rail" type="slide" axis="1 0 0" stiffness="30" springref="0.1" armature="0.2"/>
      <inertial pos="0 0.02 0" mass="3" diaginertia="0.02 0.03 0.04"/>
      <body name="link" pos="0 0 0.3">
        <joint name="turn" type="hinge" axis="0 1 0.2" stiffness="2"/>
        <inertial pos="0.1 0 0.05" euler="20 30 0" mass="1.5" diaginertia="0.005 0.02 0.021"/>
        <body name="hand" pos="0.4 0 0" gravcomp="0.5">
          <joint name="wrist" type="ball"/>
          <inertial pos="0.05 0.01 0" mass="0.4" diaginertia="1e-3 2e-3 2.5e-3"/>
          <geom size="0.05" mass="0"/>
          <site name="grip"/>
          <body name="tool" pos="0.1 0 0"><inertial pos="0 0 0" mass="0" diaginertia="0 0 0"/></body>
        </body>
      </body>
    </body>
  </worldbody>
  <sensor><force site="grip"/><torque site="grip"/><accelerometer site="grip"/></sensor>
</mujoco>"""

ROWS = 30

ROUND_OFF = 1e-9
"""Of the largest effort: directions are computed by a departure of a tenth."""


@pytest.fixture
def rng():
    return np.random.default_rng(8)


def arm(floor=""):
    spec = mujoco.MjSpec.from_string(ARM.format(floor=floor))
    for body in spec.bodies:
        body.simple = 0
    model = spec.compile()
    model.body_sameframe[model.body("tool").id] = 0  # its centre may move
    return model


def motion(model, rng):
    q = rng.normal(size=(ROWS, model.nq))
    for row in q:
        row[2:6] /= np.linalg.norm(row[2:6])
    return q, rng.normal(size=(ROWS, model.nv)), 5.0 * rng.normal(size=(ROWS, model.nv))


def other(model, rng, bodies):
    """The same machine with other masses, centres, inertias, rotors and springs."""
    found = copy.copy(model)
    for n in bodies:
        found.body_mass[n] = found.body_mass[n] * rng.uniform(0.5, 2.0) + rng.uniform(0.0, 0.1)
        found.body_ipos[n] += rng.normal(0.0, 0.05, 3)
        found.body_inertia[n] = found.body_inertia[n] * rng.uniform(0.5, 2.0, 3)
    found.dof_armature[:2] = rng.uniform(0.0, 0.5, 2)
    found.jnt_stiffness[:2] = rng.uniform(0.0, 50.0, 2)
    mujoco.mj_setConst(found, mujoco.MjData(found))
    return found


def test_any_inertial_numbers_give_the_efforts_and_readings_of_mujoco(rng):
    model = arm()
    path = motion(model, rng)
    efforts = RigidEfforts(model, *path)
    for _ in range(8):
        changed = other(model, rng, range(1, model.nbody))
        summed, direct = efforts.of(changed), inverted(changed, *path)
        for one, two in ((summed.effort, direct.effort), (summed.sensed, direct.sensed)):
            assert np.max(np.abs(one - two)) < ROUND_OFF * np.max(np.abs(two))
        assert np.max(np.abs(direct.effort - efforts.of(model).effort)) > 1.0


def test_bodies_that_mujoco_simplifies_are_no_exception(rng):
    """It takes the inertia of such a joint from what it derived once."""
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><body name="rod"><joint type="slide" axis="1 0 0"/>
        <inertial pos="0 0 0" mass="20" diaginertia="3 2 1"/></body></worldbody></mujoco>"""
    )
    assert model.body_simple[1]
    path = tuple(rng.normal(size=(ROWS, 1)) for _ in range(3))
    changed = copy.copy(model)
    changed.body_mass[1] += 9.0
    changed.body_inertia[1] *= 29.0 / 20.0
    changed.dof_armature[0] = 2.0
    mujoco.mj_setConst(changed, mujoco.MjData(changed))
    summed = RigidEfforts(model, *path).of(changed).effort
    assert summed == pytest.approx(31.0 * path[2], rel=ROUND_OFF)
    assert summed == pytest.approx(inverted(changed, *path).effort, rel=ROUND_OFF)


def test_small_departures_are_as_exact_for_their_size(rng):
    """Columns are computed from such ones."""
    model = arm()
    path = motion(model, rng)
    efforts = RigidEfforts(model, *path)
    before = efforts.of(model).effort
    for size in (0.1, 1e-3):
        changed = copy.copy(model)
        changed.body_ipos[2, 0] += size
        change = efforts.of(changed).effort - before
        direct = inverted(changed, *path).effort - before
        assert np.max(np.abs(change - direct)) < 1e-8 * np.max(np.abs(direct))


def test_a_direction_is_computed_once(rng, monkeypatch):
    passes, inner = [], rigid_efforts.inverted
    monkeypatch.setattr(rigid_efforts, "inverted", lambda *a: passes.append(0) or inner(*a))
    model = arm()
    efforts = RigidEfforts(model, *motion(model, rng))
    counts = []
    for mass in (0.1, 0.2, 0.3):
        changed = copy.copy(model)
        changed.body_mass[2] += mass
        efforts.of(changed)
        counts.append(len(passes))
    assert 2 <= counts[0] <= 11
    assert counts == 3 * counts[:1]


BENT = {
    "contact": '<geom type="plane" pos="0 0 1.2" size="9 9 1"/>',
    "a frame of a centre of mass": "<sensor><framepos objtype='body' objname='link'/></sensor>",
    "springs that are off": '<option><flag spring="disable"/></option>',
    "air": '<option density="1.2"/>',
}


@pytest.mark.parametrize("what", BENT)
def test_where_efforts_bend_they_are_not_summed(rng, what):
    floor = BENT[what] if what == "contact" else ""
    text = ARM.format(floor=floor)
    if what != "contact":
        text = text.replace("</mujoco>", BENT[what] + "</mujoco>")
    model = mujoco.MjModel.from_xml_string(text)
    assert not RigidEfforts(model, *motion(model, rng)).linear
    plain = arm()
    assert RigidEfforts(plain, *motion(plain, rng)).linear


def test_a_payload_on_a_light_flange_is_as_exact(rng):
    model = arm()
    path = motion(model, rng)
    model.body_mass[3], model.body_inertia[3] = 1e-3, [1e-8, 1e-8, 1e-8]
    mujoco.mj_setConst(model, mujoco.MjData(model))
    heavy = copy.copy(model)
    heavy.body_mass[3], heavy.body_ipos[3] = 5.0, [0.1, 0.0, 0.2]
    mujoco.mj_setConst(heavy, mujoco.MjData(heavy))
    summed, direct = RigidEfforts(model, *path).of(heavy).effort, inverted(heavy, *path).effort
    assert np.max(np.abs(summed - direct)) < ROUND_OFF * np.max(np.abs(direct))


def test_numbers_that_are_set_are_read_again(rng):
    model = arm()
    wanted = inertials(other(model, rng, [2]))
    set_inertials(model, 2, wanted[2])
    assert inertials(model)[2] == pytest.approx(wanted[2], rel=1e-12)


def test_a_model_takes_what_bodies_weigh_from_another_one(rng):
    model = arm()
    heavier, moved = other(model, rng, [1, 2, 3]), copy.copy(model)
    moved.body_pos[2, 0] += 0.1
    assert content(with_inertials_of(heavier, model)) == content(model)
    assert content(with_inertials_of(moved, model)) == content(moved)
    assert content(heavier) != content(model)


def content(model):
    found = np.empty(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, found)
    return found.tobytes()


def test_what_was_asked_before_changes_no_bit(rng):
    model = arm()
    path = motion(model, rng)
    one, two = (other(model, rng, range(1, model.nbody)) for _ in range(2))
    first, second = RigidEfforts(model, *path), RigidEfforts(model, *path)
    begun = first.of(one), first.of(two)
    turned = second.of(two), second.of(one)
    for a, b in zip(begun, turned[::-1], strict=True):
        assert np.array_equal(a.effort, b.effort)
        assert np.array_equal(a.sensed, b.sensed)
