"""A rig for tests: an arm under gravity that a position servo moves, its command filtered."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """
<mujoco model="servo">
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody>
    <body name="arm">
      <joint name="swing" axis="0 1 0" damping="0.02" armature="0.002"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.01" mass="0.2"/>
    </body>
  </worldbody>
  <actuator>
    <general name="servo" joint="swing" dyntype="filter" dynprm="0.06" gainprm="8"
             biastype="affine" biasprm="0 -8 -0.3"/>
  </actuator>
</mujoco>
"""

TARGETS = {
    "servo_stiffness": ["servo"],
    "servo_damping": ["servo"],
    "servo_strength": ["servo"],
    "actuator_lag": ["servo"],
}

EFFECTS = "effects = [" + ", ".join(f'{{ kind = "{k}", on = ["servo"] }}' for k in TARGETS) + "]"

TOML = f"""
schema = 1
kind = "rig"
name = "servo"
model = "servo.xml"
clock = {{ column = "t" }}
drive = {{ mode = "control", actuators = {{ servo = "target" }}, smoothing = "20 Hz" }}
{EFFECTS}

[signals]
target = {{ columns = ["u"], unit = "rad" }}
angle = {{ columns = ["a"], unit = "rad", noise = 1e-3 }}

[compare]
angle = {{ joint = "swing" }}

[start]
swing = {{ position = "measured", sd = "1 mrad", speed_sd = "0.1 rad/s" }}

[typical.joint]
swing = {{ effort = "1 N*m", speed = "5 rad/s", travel = "2 rad" }}
"""

TIME = 0.01 * np.arange(400)


def rig(folder: Path, toml: str = TOML, model: str = MODEL) -> Rig:
    (folder / "servo.xml").write_text(model)
    path = folder / "servo.toml"
    path.write_text(toml)
    return Rig.load(str(path))


def programme() -> Excitation:
    """A set-point that begins where the arm hangs, and the angle at the start."""
    target = 0.8 * np.sin(5.0 * TIME) * np.tanh(TIME)
    fed = {"target": target, "angle": np.zeros_like(target)}
    return Excitation("test", TIME, {name: rows[:, None] for name, rows in fed.items()})
