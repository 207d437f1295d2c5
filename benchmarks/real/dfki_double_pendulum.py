"""Double pendulum of three designs: motion fed in, both torques compared; rigid bodies given."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from real.machine import OF_JOINTS, Set, effects, machine, read

PERIOD = 0.002
"""Of the even clock that the jittery stamps are put on [s]."""

MODEL = """<mujoco model="double_pendulum">
  <option gravity="0 0 -9.81"><flag contact="disable"/></option>
  <worldbody>
    <body name="upper"><joint name="shoulder" axis="0 -1 0"/>
      <inertial pos="0 0 -{r1}" mass="{m1}" diaginertia="{i1} {i1} 1e-3"/>
      <body name="lower" pos="0 0 -{l1}"><joint name="elbow" axis="0 -1 0"/>
        <inertial pos="0 0 -{r2}" mass="{m2}" diaginertia="{i2} {i2} 1e-3"/></body>
    </body>
  </worldbody>
  <actuator><motor name="motor_1" joint="shoulder"/><motor name="motor_2" joint="elbow"/></actuator>
</mujoco>
"""

HEAD = """schema = 1
kind = "rig"
name = "{name}"
model = "{name}.xml"
rate = 25
[clock]
column = "t"
[drive]
mode = "motion"
joints = {{ shoulder = "q.1", elbow = "q.2" }}
smoothing = "10 Hz"
"""

JOINTS, MOTORS, BODIES = ("shoulder", "elbow"), ("motor_1", "motor_2"), ("upper", "lower")
TORQUES = ("torque.1", "torque.2")


def model(parameters: Mapping[str, float]) -> str:
    """Rigid bodies of a published identification, without its frictions and rotors.

    Its inertias are about the joints.
    """
    told = {name: parameters[name] for name in ("m1", "m2", "r1", "r2", "l1")}
    for k in "12":
        about = parameters[f"I{k}"] - parameters[f"m{k}"] * parameters[f"r{k}"] ** 2
        told[f"i{k}"] = max(about, 0.1 * parameters[f"I{k}"])
    return MODEL.format(**told)


def description(name: str, parameters: Mapping[str, float], other: bool) -> str:
    """The machine's file; link lengths are open where the model is that of another design."""
    text = HEAD.format(name=name)
    for k, joint in enumerate(JOINTS, 1):
        mass = parameters[f"m{k}"]
        text += f'[signals."q.{k}"]\ncolumns = ["q{k}"]\nunit = "rad"\n'
        text += f'[signals."torque.{k}"]\ncolumns = ["tau{k}"]\nunit = "N*m"\nnoise = 0.02\n'
        text += f'[compare."torque.{k}"]\nactuator = "motor_{k}"\n'
        text += f"[typical.joint.{joint}]\neffort = 2\nspeed = 10\ntravel = 2\n"
        text += f'[typical.signal."torque.{k}"]\nspan = 2\n'
        body = BODIES[k - 1]
        text += f'[[parameters]]\nbody = "{body}"\nattribute = "mass"\nsd = {0.05 * mass}\n'
        text += f'[[parameters]]\nbody = "{body}"\nattribute = "centre_z"\nsd = "5 mm"\n'
    return text + effects(
        *((kind, JOINTS) for kind in OF_JOINTS),
        ("actuator_delay", MOTORS),
        ("sensor_gain", [f"{t}.1" for t in TORQUES]),
        ("body_mass", BODIES),
        ("mass_centre", [f"{b}.{axis}" for b in BODIES for axis in "xz"]),
        ("body_inertia", BODIES),
        *([("body_place", ["lower.z"])] if other else []),
    )


def even(log: Path, folder: Path) -> Path:
    """Angles and measured torques of a log on an even clock."""
    table = np.genfromtxt(log, delimiter=",", names=True)
    time = np.arange(table["time_s"][0], table["time_s"][-1], PERIOD)
    q = [CubicSpline(table["time_s"], table[f"q{k}_rad"])(time) for k in (1, 2)]
    tau = [np.interp(time, table["time_s"], table[f"tau_meas{k}_Nm"]) for k in (1, 2)]
    path = folder / log.name
    np.savetxt(
        path,
        np.column_stack([time, *q, *tau]),
        "%.9g",
        ",",
        header="t,q1,q2,tau1,tau2",
        comments="",
    )
    return path


def published(path: Path) -> dict[str, float]:
    """Numbers of a published identification."""
    pairs = (line.split(":") for line in path.read_text().splitlines() if ":" in line)
    return {name.strip(): float(value) for name, value in pairs}


SETS = (
    ("C1", "C.1_model_1.0", ("C1_154220",), ("C1_154548",), "0.132, 0.119 N m"),
    (
        "C1 sweeps",
        "C.1_model_1.0",
        ("C1_143339", "C1_143524", "C1_143704", "C1_144115"),
        ("C1_154220",),
        "0.189, 0.139 N m",
    ),
    (
        "C0 by A0",
        "A.0_model_2.0",
        ("C0_traj00", "C0_traj01", "C0_traj03"),
        ("C0_traj05", "C0_traj12"),
        "link lengths",
    ),
)


def sets(data: Path, folder: Path) -> list[Set]:
    """A swing-up by another, swing-up by sweeps, and one design against the model of another."""
    here, found = data / "dfki_double_pendulum", []
    for name, file, fitted, held, expert in SETS:
        numbers = published(here / f"params_design_{file}.yml")
        label = name.replace(" ", "_")
        rig = machine(folder, label, model(numbers), description(label, numbers, " by " in name))
        logs = [
            [read(rig, even(here / f"{n}.csv", folder)) for n in names] for names in (fitted, held)
        ]
        found.append(Set(f"double pendulum {name}", rig, *logs, expert, "not worse"))
    return found
