"""A cheap rig for tests: a carriage on a rail, and its log on one day."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

MODEL = """
<mujoco model="slide">
  <option timestep="0.005" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="carriage">
      <joint name="rail" type="slide" axis="1 0 0" damping="10" solreffriction="0.01 1"/>
      <geom type="box" size="0.1 0.08 0.04" mass="5"/>
    </body>
  </worldbody>
  <actuator><motor name="drive" joint="rail"/></actuator>
</mujoco>
"""

TOML = """
schema = 1
kind = "rig"
name = "slide"
model = "slide.xml"

[clock]
column = "t"

[signals."drive.force"]
columns = ["f"]
unit = "N"

[signals."carriage.position"]
columns = ["x"]
unit = "m"
noise = "0.1 mm"

[drive]
mode = "control"
actuators = { drive = "drive.force" }

[compare."carriage.position"]
joint = "rail"

[start.rail]
sd = "0.1 mm"

[typical.joint.rail]
effort = "15 N"
speed = "0.5 m/s"
travel = "0.5 m"

[[parameters]]
body = "carriage"
attribute = "mass"
sd = "20 g"

[[parameters]]
joint = "rail"
attribute = "damping"
sd = 0.2

[[effects]]
kind = "coulomb_friction"
on = ["rail"]

[[effects]]
kind = "viscous_friction"
on = ["rail"]

[[effects]]
kind = "joint_spring"
on = ["rail"]

[[effects]]
kind = "body_mass"
on = ["carriage"]

[[effects]]
kind = "actuator_gain"
on = ["drive"]
sd = 0.002

[[effects]]
kind = "actuator_delay"
on = ["drive"]
"""

ROWS, PERIOD = 600, 0.01


def write_files(folder: Path) -> Path:
    (folder / "slide.xml").write_text(MODEL)
    (folder / "slide.toml").write_text(TOML)
    return folder / "slide.toml"


def machine(rng: np.random.Generator) -> dict[str, float]:
    """One machine: its commissioning errors, within their sd."""
    return {
        "mass": 5.0 + 0.02 * rng.standard_normal(),
        "damping": 10.0 + 0.2 * rng.standard_normal(),
        "gain": 1.0 + 0.002 * rng.standard_normal(),
    }


def write_day(
    path: Path, rng: np.random.Generator, made: dict[str, float], friction: float
) -> None:
    """A log of one day: a programme of its own, a start of its own, encoder noise."""
    spec = mujoco.MjSpec.from_string(MODEL)
    spec.joint("rail").frictionloss = friction
    spec.joint("rail").damping = np.array([made["damping"], 0.0, 0.0])
    spec.geoms[0].mass = made["mass"]
    model = spec.compile()
    model.actuator_gainprm[0, 0] = made["gain"]
    data = mujoco.MjData(model)
    data.qpos[0] = 1e-4 * rng.standard_normal()
    tones, phase = 6.28 * rng.uniform(0.2, 1.4, 4), rng.uniform(0, 6.28, 4)
    lines = ["t,f,x"]
    for k in range(ROWS):
        force = 6.0 * float(np.sum(np.sin(tones * PERIOD * k + phase)))
        lines.append(
            f"{PERIOD * k:.2f},{force:.6f},{data.qpos[0] + 1e-4 * rng.standard_normal():.8f}"
        )
        data.ctrl[0] = force
        for _ in range(2):
            mujoco.mj_step(model, data)
    path.write_text("\n".join(lines))
