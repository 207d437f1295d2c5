"""An arm of three joints and logs of it: torques by inverse dynamics, friction, noise."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from three_joints import ARM, moved


@pytest.fixture(scope="session")
def columns() -> dict[str, np.ndarray]:
    """Time, positions q1 to q3 [rad], speeds, torques of the motors with 8 % of friction."""
    time, q, v, torque = moved(mujoco.MjModel.from_xml_string(ARM), 2)
    rng = np.random.default_rng(3)
    torque += 0.08 * np.std(torque, axis=1, keepdims=True) * np.sign(v)
    torque += 0.01 * rng.standard_normal(torque.shape)
    q = q + 1e-6 * rng.standard_normal(q.shape)
    found = {"t": time}
    found |= {f"q{i + 1}": q[i] for i in range(3)}
    found |= {f"dq{i + 1}": v[i] + 1e-3 * rng.standard_normal(len(time)) for i in range(3)}
    return found | {f"tau{i + 1}": torque[i] for i in range(3)}


@pytest.fixture
def arm(tmp_path) -> Path:
    """The model's file."""
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    return path


@pytest.fixture
def write(tmp_path):
    """Writes columns as a log."""

    def written(columns: dict[str, np.ndarray], name: str = "log.csv") -> Path:
        path = tmp_path / name
        rows = np.column_stack(list(columns.values()))
        np.savetxt(path, rows, "%.9g", ",", header=",".join(columns), comments="")
        return path

    return written


SWING = """
<mujoco model="swing">
  <option timestep="0.002" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody><body name="link">
    <joint name="joint" axis="0 1 0" damping="0.05"/>
    <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="1"/>
  </body></worldbody>
  <actuator><motor name="drive" joint="joint"/></actuator>
</mujoco>
"""


@pytest.fixture
def swing(tmp_path) -> tuple[Path, dict[str, np.ndarray]]:
    """A pendulum's file, and columns of it behind noisy sensors: t, tau, q, dq."""
    path = tmp_path / "swing.xml"
    path.write_text(SWING)
    model, rng = mujoco.MjModel.from_xml_string(SWING), np.random.default_rng(8)
    data, rows = mujoco.MjData(model), np.zeros((1500, 4))
    for k in range(len(rows)):
        tau = 0.3 * np.sin(0.04 * k) + 0.3 * np.sin(0.071 * k + 1.0)
        noise = np.array([0.003, 0.02]) * rng.standard_normal(2)
        rows[k] = 0.01 * k, tau, data.qpos[0] + noise[0], data.qvel[0] + noise[1]
        data.ctrl[0] = tau
        for _ in range(5):
            mujoco.mj_step(model, data)
    return path, dict(zip(("t", "tau", "q", "dq"), rows.T, strict=True))
