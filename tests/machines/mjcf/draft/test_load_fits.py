"""load_fits: another tool on an arm is no wrong sign, unit or zero of its columns."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from three_joints import ARM

from ves_twin.machines.mjcf.draft.draft import draft
from ves_twin.machines.mjcf.parts.inertials import inertials, point_mass
from ves_twin.machines.mjcf.plausible import implausible as module
from ves_twin.machines.mjcf.plausible.implausible import implausible
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.rig.machine import Rig

WRISTED = ARM.replace(
    """mass="1"/>
        </body>""",
    """mass="1"/>
          <body name="hand" pos="0.3 0 0"><joint name="roll" axis="1 0 0" damping="0.02"/>
            <geom size="0.03" pos="0.05 0.05 0" mass="0.2"/></body>
        </body>""",
).replace("</actuator>", '<motor name="m4" joint="roll"/></actuator>')
"""The arm with a hand whose mass is off its axis, to one side."""

LOAD, AT = 0.2, (0.05, -0.1, 0.0)
"""A tool [kg, m] that is off to the other side: gravity turns the hand as if half a turn on."""


def logged(path: Path, load: float = 0.0, **factors: float) -> Path:
    """A log of the arm with a load, its columns times factors."""
    spec = mujoco.MjSpec.from_string(WRISTED)
    if load:
        spec.body("hand").add_body(pos=AT).add_geom(size=[0.01] * 3, mass=load)
    model = spec.compile()
    data, time = mujoco.MjData(model), 0.005 * np.arange(1600)
    w = 2.0 * np.pi * np.array([0.31, 0.43, 0.53, 0.37])[:, None]
    phase, reach = np.arange(4.0)[:, None], np.array([0.8, 0.5, 0.7, 1.2])[:, None]
    q, v = reach * np.sin(w * time + phase), reach * w * np.cos(w * time + phase)
    torque = np.zeros(q.shape)
    for k in range(len(time)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[:, k], v[:, k], -(w[:, 0] ** 2) * q[:, k]
        mujoco.mj_inverse(model, data)
        torque[:, k] = data.qfrc_inverse
    columns = {"t_s": time}
    columns |= {f"q{n + 1}_rad": q[n] for n in range(4)}
    columns |= {f"tau{n + 1}_Nm": torque[n] for n in range(4)}
    rows = [factors.get(name, 1.0) * values for name, values in columns.items()]
    np.savetxt(path, np.transpose(rows), "%.9g", ",", header=",".join(columns), comments="")
    return path


@pytest.fixture
def rig(tmp_path) -> Rig:
    """The arm as it is, drafted from a log in order."""
    (tmp_path / "arm.xml").write_text(WRISTED)
    text = draft(tmp_path / "arm.xml", [logged(tmp_path / "ok.csv")], tmp_path / "arm.toml").text
    (tmp_path / "arm.toml").write_text(text)
    return Rig.load(str(tmp_path / "arm.toml"))


def test_a_load_that_turns_gravity_round_is_no_wrong_zero(rig, tmp_path, monkeypatch):
    recording = read_rig_recording(logged(tmp_path / "load.csv", LOAD), rig)
    assert implausible(rig, recording) is None
    monkeypatch.setattr(module, "load_fits", lambda *_: False)
    assert implausible(rig, recording) is not None  # what was said of it before


@pytest.mark.parametrize("column", ["q2_rad", "q3_rad", "tau1_Nm", "tau2_Nm", "tau4_Nm"])
def test_no_load_passes_for_a_column_that_counts_the_other_way(rig, tmp_path, column):
    recording = read_rig_recording(logged(tmp_path / "wrong.csv", **{column: -1.0}), rig)
    told = implausible(rig, recording)
    assert told is not None
    assert "the other sign" in told.came


def test_a_point_mass_has_the_numbers_of_a_small_ball():
    place = np.array([0.1, -0.2, 0.3])
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><freejoint/><geom size="1e-4" mass="2" pos="0.1 -0.2 0.3"/>'
        "</body></worldbody></mujoco>"
    )
    # the ball's own inertia, 2/5 m r^2, is 8e-9
    np.testing.assert_allclose(inertials(model)[1], point_mass(2.0, place), atol=1e-8)
