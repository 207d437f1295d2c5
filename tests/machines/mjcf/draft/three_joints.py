"""An arm of three joints, and the torques that its motion needs."""

from __future__ import annotations

import mujoco
import numpy as np

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


def moved(model: mujoco.MjModel, seed: int) -> tuple[np.ndarray, ...]:
    """Time (n,), positions, speeds and torques (3, n) of an arm along tones of chance phases."""
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    time = PERIOD * np.arange(1600)
    w = 2.0 * np.pi * np.array([[0.31, 0.83], [0.43, 1.02], [0.53, 1.21]])
    phase = rng.uniform(0.0, 6.28, w.shape)
    waves = w[..., None] * time + phase[..., None]
    reach = np.array([[0.8, 0.2], [0.5, 0.2], [0.7, 0.3]])[..., None]
    q, v = (reach * np.sin(waves)).sum(1), (reach * w[..., None] * np.cos(waves)).sum(1)
    a = -(reach * w[..., None] ** 2 * np.sin(waves)).sum(1)
    torque = np.zeros((3, len(time)))
    for k in range(len(time)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[:, k], v[:, k], a[:, k]
        mujoco.mj_inverse(model, data)
        torque[:, k] = data.qfrc_inverse
    return time, q, v, torque
