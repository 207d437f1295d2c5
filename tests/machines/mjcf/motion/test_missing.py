"""What a measured motion asks of joints beyond the model, of joints that nothing drives, too."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from arm import JOINT, MODEL, TOML, motion

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

EDGE = 10
"""Rows off either end: differences of second order are one-sided there."""


def passive(folder: Path, joint: str = "") -> MjcfForward:
    """The arm with a motor at its first joint alone; further attributes of its second joint."""
    model = MODEL.replace('<motor name="mb" joint="b"/>', "").replace(
        '<joint name="b"', f'<joint name="b" {joint}'
    )
    (folder / "arm.xml").write_text(model)
    told = JOINT.format("a") + JOINT.format("b").split("[signals.tb]")[0]
    told += '[compare.qb]\njoint = "b"\nof = "position"\n'
    (folder / "arm.toml").write_text(TOML.replace(', mb = "tb"', "") + told)
    return MjcfForward.of(Rig.load(str(folder / "arm.toml")), Mode.CONTROL)


def moved(forward: MjcfForward, laws: tuple[Law, ...] = ()):
    """A motion under torques at the first joint, by name, and what was fed in."""
    time, torques = motion(6.0, 3)
    fed = Excitation("", time, {"ta": torques[:, :1]})
    rows = forward.simulate(fed, {}, False, laws)
    names = [channel.name for channel in forward.channels]
    return fed, dict(zip(names, rows.T, strict=True))


def test_a_joint_that_nothing_drives_asks_for_the_law_that_acts_there(tmp_path):
    """v|v| of 0.3 N m s^2, to the 2 % that differences over 20 ms are off by."""
    forward = passive(tmp_path)
    x = np.linspace(-9.0, 9.0, 181)
    law = Law(
        "b", LawKind.EFFORT, LawShape.TABLE, ("speed@b",), (tuple(x),), tuple(-0.3 * x * abs(x))
    )
    fed, measured = moved(forward, (law,))
    efforts, path = forward.missing(fed, {}, measured)
    inner = slice(EDGE, -EDGE)
    acting = law.at(path["speed@b"])[inner]
    assert np.std(acting) > 0.1
    assert np.std(efforts["b"][inner] - acting) < 0.05 * np.std(acting)
    assert np.std(efforts["a"][inner]) < 0.05 * np.std(fed.drive["ta"])


def test_a_joint_at_its_limit_tells_nothing(tmp_path):
    forward = passive(tmp_path, 'limited="true" range="-10 10"')
    fed, measured = moved(forward)
    assert np.max(np.abs(measured["qb"])) > np.radians(10.0)
    assert forward.missing(fed, {}, measured) is None
