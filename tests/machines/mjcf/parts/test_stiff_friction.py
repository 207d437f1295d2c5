"""Dry friction of a machine that any MuJoCo model describes sticks, unless its file has it soft."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import two_link
from two_link import TIME, programme, rig

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode

SOFT = ' solreffriction="0.005 1"'


@pytest.fixture
def default(monkeypatch):
    """The cart with MuJoCo's default softness, and next to no spring."""
    model = two_link.MODEL.replace(SOFT, "").replace('stiffness="3"', 'stiffness="1e-6"')
    monkeypatch.setattr(two_link, "MODEL", model)


def test_a_cart_below_its_level_of_friction_stays_where_it_is(default, tmp_path):
    """With the engine's softness 8 N against 10 N creep by 8 * 0.1 / (0.9 * 4.3 * 105) m/s."""
    machine = rig(tmp_path)
    fed = {name: np.zeros_like(values) for name, values in programme().drive.items()}
    fed["drive.force"] += 8.0
    rows = MjcfForward.of(machine, Mode.CONTROL).simulate(
        Excitation("push", TIME, fed), {"coulomb_friction@rail:level": 10.0}
    )
    assert TIME[-1] * 8.0 * 0.1 / (0.9 * 4.3 * 105.0) > 5e-3
    assert np.ptp(rows[:, 0]) < 2e-5


@pytest.mark.parametrize("level", [1.0, 5.0])
def test_backwards_from_a_forward_motion_the_command_is_the_one_that_was_fed(
    default, tmp_path, level
):
    machine = rig(tmp_path)
    values = {"coulomb_friction@rail:level": level}
    fed = programme()
    ahead = MjcfForward.of(machine, Mode.CONTROL)
    path = ahead.simulate(fed, values)
    names = [c.name for c in ahead.channels]
    motion = {n: path[:, [names.index(n)]] for n in ("cart.position", "arm.angle")}
    back = MjcfForward.of(machine, Mode.MOTION)
    asked = back.simulate(Excitation("back", TIME, fed.drive | motion), values)
    command = asked[:, [c.name for c in back.channels].index("drive.force")]
    speed = np.gradient(motion["cart.position"][:, 0], TIME)
    moving = np.abs(speed) > 0.02
    moving[:100] = moving[-100:] = False  # where the low-pass has no neighbours
    off = (command - fed.drive["drive.force"][:, 0])[moving]
    assert np.sqrt(np.mean(off**2)) < 0.1 * level


def test_a_softness_that_the_file_has_stays(tmp_path):
    model = rig(tmp_path).model
    rail, swing = (int(model.joint(name).dofadr[0]) for name in ("rail", "swing"))
    assert model.dof_solref[rail].tolist() == [0.005, 1.0]
    assert model.dof_solref[swing].tolist() == [0.002, 1.0]
    assert isinstance(model, mujoco.MjModel)
