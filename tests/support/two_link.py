"""A rig for tests: a cart and a swinging arm with a force sensor, in every mode."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """
<mujoco model="two_link">
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="cart">
      <joint name="rail" type="slide" axis="1 0 0" damping="4" frictionloss="0.5" armature="0.2"
             stiffness="3" solreffriction="0.005 1"/>
      <geom type="box" size="0.1 0.08 0.04" mass="3"/>
      <body name="arm">
        <joint name="swing" axis="0 1 0" damping="0.1"/>
        <geom type="capsule" fromto="0 0 0 0.1 0 -0.4" size="0.02" mass="0.8"/>
        <site name="tip"/>
        <body name="hook" pos="0.1 0 -0.4"><geom size="0.02" mass="0.2"/></body>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="belt"><joint joint="swing" coef="0.5"/></fixed>
    <fixed name="cord" stiffness="0.02"><joint joint="swing" coef="1"/></fixed>
  </tendon>
  <actuator><motor name="drive" joint="rail"/><motor name="hinge" joint="swing"/></actuator>
  <sensor><force name="load" site="tip"/></sensor>
</mujoco>
"""

KINDS = """
[[effects]]
kind = "{kind}"
on = {on}
"""

TARGETS = {
    "viscous_friction": ["rail", "swing"],
    "coulomb_friction": ["rail"],
    "viscous_asymmetry": ["rail"],
    "coulomb_asymmetry": ["rail"],
    "force_offset": ["rail", "swing"],
    "joint_spring": ["rail"],
    "joint_compliance": ["rail"],
    "cubic_spring": ["rail"],
    "load_friction": ["rail"],
    "body_place": ["hook.z"],
    "gravity_direction": ["y"],
    "clock_rate": ["clock"],
    "rotor_inertia": ["rail"],
    "backlash": ["swing"],
    "quadratic_drag": ["rail"],
    "stribeck_friction": ["rail"],
    "regularized_friction": ["rail"],
    "friction_behind_gap": ["rail"],
    "one_way_load": ["rail"],
    "dahl_friction": ["rail"],
    "ripple": ["swing.6"],
    "coupling_inertia": ["belt"],
    "coupling_viscous": ["belt"],
    "coupling_coulomb": ["belt"],
    "coupling_spring": ["cord"],
    "actuator_gain": ["drive"],
    "actuator_delay": ["drive"],
    "actuator_offset": ["drive"],
    "actuator_deadband": ["drive"],
    "actuator_asymmetry": ["drive"],
    "actuator_saturation": ["drive"],
    "drive_cross_talk": ["drive from hinge"],
    "payload": ["arm"],
    "body_mass": ["cart", "arm"],
    "mass_centre": ["arm.x", "arm.z"],
    "body_inertia": ["arm"],
    "sensor_gain": ["load.force.1"],
    "cross_talk": ["load.force.3.1"],
    "sensor_offset": ["load.force.2"],
    "sensor_wander": ["load.force.3"],
    "sensor_delay": ["load.force"],
}

TOML = """
schema = 1
kind = "rig"
name = "two_link"
model = "two_link.xml"

[clock]
column = "t"

[signals."drive.force"]
columns = ["f"]
unit = "N"
noise = 0.1

[signals."hinge.torque"]
columns = ["m"]
unit = "N*m"
noise = 0.01

[signals."cart.set"]
columns = ["set"]
unit = "m"

[signals."cart.position"]
columns = ["x"]
unit = "m"
noise = 1e-5

[signals."arm.angle"]
columns = ["a"]
unit = "rad"
noise = 1e-5

[signals."load.force"]
columns = ["fx", "fy", "fz"]
unit = "N"
noise = 0.05

[drive]
mode = "{mode}"
joints = {{ rail = "cart.position", swing = "arm.angle" }}
actuators = {{ drive = "drive.force", hinge = "hinge.torque" }}
smoothing = "60 Hz"

[compare."drive.force"]
actuator = "drive"

[compare."hinge.torque"]
actuator = "hinge"

[compare."cart.position"]
joint = "rail"

[compare."arm.angle"]
joint = "swing"

[compare."load.force"]
sensor = "load"

[controllers.drive]
kind = "pd"
joint = "rail"
reference = "cart.set"
kp = 400
kd = 40
limit = 100

[start.rail]
sd = 1e-5

[typical.joint.rail]
effort = "20 N"
speed = "0.5 m/s"
travel = "0.5 m"

[typical.joint.swing]
effort = "2 N*m"
speed = "1 rad/s"
travel = "1 rad"

[typical.signal."load.force"]
span = "10 N"

[drift]
end = 4.0
terms = 3

[[parameters]]
body = "cart"
attribute = "mass"
value = "3.1 kg"
sd = "0.05 kg"
"""

TIME = 0.002 * np.arange(2000)


def write_files(folder: Path, mode: str = "control", more: str = "", kinds=TARGETS) -> Path:
    (folder / "two_link.xml").write_text(MODEL)
    text = TOML.format(mode=mode)
    for kind, on in kinds.items():
        text += KINDS.format(kind=kind, on=str(on).replace("'", '"'))
    path = folder / "two_link.toml"
    path.write_text(text + more)
    return path


def rig(folder: Path, mode: str = "control", more: str = "") -> Rig:
    return Rig.load(str(write_files(folder, mode, more)))


def programme() -> Excitation:
    """Everything that any mode feeds in: smooth motion, efforts, set-points."""
    t = TIME
    x = 0.1 * np.sin(3.0 * t) * np.tanh(2.0 * t)
    a = 0.4 * np.sin(4.0 * t + 0.5) - 0.4 * np.sin(0.5)
    fed = {
        "cart.position": x,
        "arm.angle": a,
        "drive.force": 15.0 * np.sin(5.0 * t),
        "hinge.torque": 1.0 * np.sin(7.0 * t + 1.0),
        "cart.set": 0.1 * np.sin(3.0 * t),
    }
    return Excitation("test", t, {name: values[:, None] for name, values in fed.items()})
