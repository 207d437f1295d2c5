"""An arm of two hinges for tests: motion fed in, or torques; a tendon over both."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="one"><joint name="a" axis="0 0 1"/><geom size="0.1" mass="1" pos="0.3 0 0"/>
      <body name="two" pos="0.5 0 0"><joint name="b" axis="0 0 1"/>
        <geom size="0.1" mass="1" pos="0.3 0 0"/></body></body>
  </worldbody>
  <tendon>
    <fixed name="sum"><joint joint="a" coef="1"/><joint joint="b" coef="1"/></fixed>
    <fixed name="difference"><joint joint="a" coef="1"/><joint joint="b" coef="-1"/></fixed>
  </tendon>
  <actuator><motor name="ma" joint="a"/><motor name="mb" joint="b"/></actuator>
</mujoco>
"""

TOML = """
schema = 1
kind = "rig"
name = "arm"
model = "arm.xml"
rate = 50
[clock]
column = "t"
[drive]
mode = "motion"
smoothing = "20 Hz"
joints = { a = "qa", b = "qb" }
actuators = { ma = "ta", mb = "tb" }
"""

JOINT = """
[typical.joint.{0}]
effort = 5
speed = 2
travel = 1
[signals.q{0}]
columns = ["q{0}"]
unit = "rad"
noise = 1e-3
[signals.t{0}]
columns = ["t{0}"]
unit = "N*m"
noise = 0.01
[compare.q{0}]
joint = "{0}"
of = "position"
[compare.t{0}]
actuator = "m{0}"
[[parameters]]
joint = "{0}"
attribute = "armature"
sd = 0.01
"""


def arm(folder: Path, effects: Mapping[str, str], more: str = "") -> Rig:
    """With effects, kind -> where each may be, and further lines of its file."""
    (folder / "arm.xml").write_text(MODEL)
    kinds = "".join(
        f'[[effects]]\nkind = "{kind}"\non = {[*on.split()]}\n' for kind, on in effects.items()
    )
    text = TOML + "".join(JOINT.format(joint) for joint in "ab") + kinds + more
    (folder / "arm.toml").write_text(text)
    return Rig.load(str(folder / "arm.toml"))


def motion(seconds: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] at 50 Hz, and angles [rad] of both joints (n, 2): a few tones each."""
    rng = np.random.default_rng(seed)
    time = 0.02 * np.arange(round(50 * seconds))
    omega, phase = rng.uniform(1.0, 6.0, (2, 4)), rng.uniform(0.0, 6.3, (2, 4))
    tones = np.sin(omega[..., None] * time + phase[..., None])
    return time, np.sum(0.6 / omega[..., None] * tones, axis=1).T
