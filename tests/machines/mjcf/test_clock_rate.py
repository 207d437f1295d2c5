"""A log whose clock runs off: every mode takes its rows for as long as the machine did."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from two_link import TIME, programme, rig

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

SHARE = 0.25

FREE = """<mujoco><option timestep="0.002" integrator="implicitfast"/>
  <worldbody><body name="link"><joint name="swing" axis="0 1 0" damping="0.01"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="1"/></body></worldbody></mujoco>"""

TOLD = """
schema = 1
kind = "rig"
name = "swing"
model = "swing.xml"
clock = { column = "t" }
drive = { mode = "control" }
effects = [{ kind = "*", on = ["*"] }]
[signals]
"swing.angle" = { columns = ["q"], unit = "rad", joint = "swing", noise = 1e-3 }
[typical.joint]
swing = { effort = 2, speed = 3, travel = 1 }
[start]
swing = { position = "measured", sd = 1e-3, speed_sd = 0.05 }
"""


@pytest.mark.parametrize("mode", [Mode.CONTROL, Mode.MOTION, Mode.REFERENCE])
def test_a_stretched_log_with_its_clock_s_rate_is_the_one_that_was_not(tmp_path, mode):
    machine, fed = rig(tmp_path, str(mode)), programme()
    forward = MjcfForward.of(machine, mode)
    true = forward.simulate(fed, {})
    short = Excitation("short", TIME / (1.0 + SHARE), fed.drive)
    told = forward.simulate(short, {"clock_rate@clock:share": SHARE})
    inner = slice(200, -200)  # which the ends of a zero-phase filter do not reach
    scale = np.maximum(np.max(np.abs(true[inner]), axis=0), 1e-3)
    # the low-pass of motion has its corner in the log's time
    np.testing.assert_allclose(told[inner] / scale, true[inner] / scale, atol=5e-3)
    assert np.max(np.abs(forward.simulate(short, {}) - true)[inner] / scale) > 0.05


def test_of_a_machine_that_is_let_go_it_is_offered_and_of_no_other(tmp_path):
    (tmp_path / "swing.xml").write_text(FREE)
    (tmp_path / "swing.toml").write_text(TOLD)
    kinds = {cause.effect for cause in Rig.load(str(tmp_path / "swing.toml")).hypotheses}
    assert "clock_rate" in kinds
    led = FREE.replace(
        "</body></worldbody>",
        """<body pos="0 0 -0.4"><joint name="tip" axis="0 1 0"/>
      <geom size="0.02" mass="0.1" pos="0 0 -0.1"/></body></body></worldbody>""",
    )
    (tmp_path / "swing.xml").write_text(led)
    imposed = (
        'drive = { mode = "control", imposed = ["swing"], joints = { swing = "swing.angle" } }'
    )
    tip = '"tip.angle" = { columns = ["p"], unit = "rad", joint = "tip", noise = 1e-3 }\n'
    told = TOLD.replace('drive = { mode = "control" }', imposed).replace(
        "[signals]\n", f"[signals]\n{tip}"
    )
    told = told.replace(
        "[start]\nswing", "tip = { effort = 1, speed = 3, travel = 1 }\n[start]\ntip"
    )
    (tmp_path / "swing.toml").write_text(told)
    assert "clock_rate" not in {c.effect for c in Rig.load(str(tmp_path / "swing.toml")).hypotheses}
    actuator = '<actuator><motor name="drive" joint="swing"/></actuator></mujoco>'
    (tmp_path / "swing.xml").write_text(FREE.replace("</mujoco>", actuator))
    fed = 'drive = { mode = "control", actuators = { drive = "u" } }'
    signal = '[signals]\nu = { columns = ["u"], unit = "N*m" }\n'
    told = TOLD.replace('drive = { mode = "control" }', fed).replace("[signals]\n", signal)
    (tmp_path / "swing.toml").write_text(told)
    kinds = {cause.effect for cause in Rig.load(str(tmp_path / "swing.toml")).hypotheses}
    assert "clock_rate" not in kinds
    assert "coulomb_friction" in kinds


def test_a_swing_that_was_logged_too_fast_falls_as_its_clock_says(tmp_path):
    model = mujoco.MjModel.from_xml_string(FREE)
    data, angle = mujoco.MjData(model), []
    data.qpos[0] = 1.0
    for _ in range(600):
        angle.append(float(data.qpos[0]))
        mujoco.mj_step(model, data, 5)
    (tmp_path / "swing.xml").write_text(FREE)
    (tmp_path / "swing.toml").write_text(TOLD)
    machine = Rig.load(str(tmp_path / "swing.toml"))
    forward = MjcfForward.of(machine)
    time = 0.01 * np.arange(600) / (1.0 + SHARE)
    fed = Excitation("swing", time, {"swing.angle": np.array(angle)[:, None]})
    told = forward.simulate(fed, {"clock_rate@clock:share": SHARE})
    assert told[:, 0] == pytest.approx(angle, abs=0.02)  # its start is told by noisy-row rules
    assert np.max(np.abs(forward.simulate(fed, {})[:, 0] - angle)) > 0.5
