"""Damper: a rod moved by a testing machine; motion fed in, force compared; a bare rod given."""

from __future__ import annotations

from pathlib import Path

from real.machine import Set, effects, machine, read

MODEL = """<mujoco model="damper">
  <option gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body name="rod"><joint name="stroke" type="slide" axis="1 0 0"/>
      <geom type="box" size="0.2 0.05 0.05" mass="20"/></body>
  </worldbody>
  <actuator><motor name="machine" joint="stroke"/></actuator>
</mujoco>
"""

TOML = """schema = 1
kind = "rig"
name = "damper"
model = "damper.xml"
rate = 64
[clock]
column = "t"
[signals.stroke]
columns = ["x"]
unit = "m"
[signals.force]
columns = ["F"]
unit = "N"
noise = 4.0                  # load cell at rest, from the data's own page
[drive]
mode = "motion"
joints = { stroke = "stroke" }
smoothing = "40 Hz"
[compare.force]
actuator = "machine"
[typical.joint.stroke]       # read off the recordings
effort = "20 kN"
speed = "0.1 m/s"
travel = "40 mm"
[typical.signal.force]
span = "20 kN"
[[parameters]]
body = "rod"
attribute = "mass"
sd = "20 kg"
"""

KINDS = (
    "viscous_friction",
    "coulomb_friction",
    "viscous_asymmetry",
    "coulomb_asymmetry",
    "stribeck_friction",
    "quadratic_drag",
    "force_offset",
    "joint_spring",
    "backlash",
    "friction_behind_gap",
)

FITTED = ("h6", "h2")
HELD_OUT = ("h10", "h7", "DuzceMCE", "ImperialValleyMCE", "KocaeliMCE")


def sets(data: Path, folder: Path) -> list[Set]:
    """Two harmonic runs fitted; two others and three earthquakes held out."""
    told = TOML + effects(*((kind, ["stroke"]) for kind in KINDS))
    rig = machine(folder, "damper", MODEL, told)
    fitted, held = (
        [read(rig, data / "damper" / f"{name}.csv") for name in names]
        for names in (FITTED, HELD_OUT)
    )
    return [Set("damper", rig, fitted, held, "2.0 to 2.3 kN", "<= 2.5 kN pooled, gap 5 to 8 mm")]
