"""Two links that hang, a motor at the first: a lively machine in open loop, for tests."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects.law import Law
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="one"><joint name="a" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.01" mass="1"/>
      <body name="two" pos="0 0 -0.25"><joint name="b" axis="0 1 0" {joint}/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.2" size="0.01" mass="0.3"/></body></body>
  </worldbody>
  <actuator><motor name="motor" joint="a"/></actuator>
</mujoco>
"""

TOML = """
schema = 1
kind = "rig"
name = "lively"
model = "lively.xml"
clock = { column = "t" }
drive = { mode = "control", smoothing = 10 }
tolerances = { mass = "2 %", gain = "2 %" }
effects = [
  { kind = "coulomb_friction", on = ["a", "b"] }, { kind = "viscous_friction", on = ["a", "b"] },
  { kind = "body_mass", on = ["one", "two"] }, { kind = "rotor_inertia", on = ["a"] },
  { kind = "actuator_gain", on = ["motor"] },
]
[signals]
"a.position" = { columns = ["qa"], unit = "rad", joint = "a", noise = 0.002 }
"b.position" = { columns = ["qb"], unit = "rad", joint = "b", noise = 0.002 }
"motor.effort" = { columns = ["u"], unit = "N*m", actuator = "motor" }
[typical.joint]
a = { effort = 1, speed = 8, travel = 2 }
b = { effort = 0.4, speed = 16, travel = 4 }
[start]
a = { position = "measured", sd = 0.002, speed_sd = 0.05 }
b = { position = "measured", sd = 0.002, speed_sd = 0.05 }
"""


def lively(folder: Path, joint: str = "") -> Rig:
    """The machine; further attributes of its second joint."""
    (folder / "lively.xml").write_text(MODEL.format(joint=joint))
    (folder / "lively.toml").write_text(TOML)
    return Rig.load(str(folder / "lively.toml"))


def torque(seconds: float, seed: int, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] at 100 Hz, and a torque of three tones of a level [N m]: (n,), (n, 1)."""
    rng = np.random.default_rng(seed)
    time = 0.01 * np.arange(round(100 * seconds))
    phase = rng.uniform(0.0, 6.3, 3)
    tones = np.sin(np.array([5.0, 7.3, 11.0])[:, None] * time + phase[:, None])
    return time, (level * np.sum(tones, axis=0))[:, None]


def measured(
    rig: Rig,
    values: dict[str, float],
    seconds: float,
    seed: int,
    level: float = 0.25,
    laws: Sequence[Law] = (),
) -> Recording:
    """What a machine with hidden values shows, with noise; tones of 0.25 N m swing it by radians."""
    forward = MjcfForward.of(rig)
    time, u = torque(seconds, seed, level)
    rest = {name: np.zeros_like(u) for name in ("a.position", "b.position")}
    rows = forward.simulate(Excitation("", time, {"motor.effort": u, **rest}), values, laws=laws)
    rows = rows + 0.002 * np.random.default_rng(seed).standard_normal(rows.shape)
    signals = {"motor.effort": u, "a.position": rows[:, :1], "b.position": rows[:, 1:]}
    return Recording(time, signals, RecordingInfo("measured", scenario=f"run {seed}"))
