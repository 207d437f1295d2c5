"""An arm of three joints and logs of it: torques by inverse dynamics, friction, noise."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

ARM = """
<mujoco model="arm">
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="base">
      <joint name="turn" axis="0 0 1" damping="0.2" armature="0.05"/>
      <geom type="box" size="0.1 0.1 0.1" mass="4"/>
      <body name="upper" pos="0 0 0.2">
        <joint name="lift" axis="0 1 0" damping="0.2"/>
        <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04" mass="3"/>
        <body name="lower" pos="0.4 0 0">
          <joint name="bend" axis="0 1 0" damping="0.1"/>
          <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="m1" joint="turn"/><motor name="m2" joint="lift"/><motor name="m3" joint="bend"/>
  </actuator>
</mujoco>
"""

PERIOD = 0.005


@pytest.fixture(scope="session")
def columns() -> dict[str, np.ndarray]:
    """Time, positions q1 to q3 [rad], speeds, torques of the motors with 8 % of friction."""
    model = mujoco.MjModel.from_xml_string(ARM)
    data, rng = mujoco.MjData(model), np.random.default_rng(2)
    time = PERIOD * np.arange(1600)
    w = 2.0 * np.pi * np.array([[0.31, 0.83], [0.43, 1.02], [0.53, 1.21]])
    phase = rng.uniform(0.0, 6.28, w.shape)
    waves = w[..., None] * time + phase[..., None]
    reach = np.array([[0.8, 0.2], [0.5, 0.2], [0.7, 0.3]])[..., None]
    q, v = (reach * np.sin(waves)).sum(1), (reach * w[..., None] * np.cos(waves)).sum(1)
    a = -(reach * w[..., None] ** 2 * np.sin(waves)).sum(1)
    torque = np.zeros((len(time), 3))
    for k in range(len(time)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[:, k], v[:, k], a[:, k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    torque += 0.08 * np.std(torque, axis=0) * np.sign(v.T)
    torque += 0.01 * rng.standard_normal(torque.shape)
    q = q + 1e-6 * rng.standard_normal(q.shape)
    found = {"t": time}
    found |= {f"q{i + 1}": q[i] for i in range(3)}
    found |= {f"dq{i + 1}": v[i] + 1e-3 * rng.standard_normal(len(time)) for i in range(3)}
    return found | {f"tau{i + 1}": torque[:, i] for i in range(3)}


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
