"""Excavator: duty of a valve to length of its cylinder, in open loop from where it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from real.machine import Set, effects, machine, read
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

PERIOD, WINDOW, LEAD = 0.025, 120, 12
"""Of the rows [s]; rows of a window, which is fitted, and told, from where the axis was measured: a
diagnosis asks for a hundred, and 3 s of the log have sixty; rows before it, which tell commands."""


@dataclass(frozen=True)
class Axis:
    """One axis of the machine.

    Attributes:
        name: of its joint and file.
        duty, length: columns of the log.
        neutral: duty at rest [%], on the data's page.
        gear: cm/s for a per cent of duty, a line through the origin and the fitted recording.
        expert, asked: what an expert leaves, and what the issue asks.
    """

    name: str
    duty: int
    length: int
    neutral: float
    gear: float
    expert: str
    asked: str


AXES = (
    Axis(
        *("boom", 1, 5, 7.474, 0.72),
        *("0.078 cm", "<= 0.078 cm; dead band, asymmetry, delay named"),
    ),
    Axis("stick", 2, 6, 6.9645, 0.95, "0.133 cm", "-"),
    Axis("bucket", 3, 7, 7.614, 1.14, "0.482 cm", "-"),
)
"""Stick and bucket were looked at when all constants had been chosen, and none was on them."""

MODEL = """<mujoco model="{name}">
  <option timestep="0.01" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="rod"><joint name="{name}" type="slide" axis="1 0 0" damping="100"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
  </worldbody>
  <actuator><motor name="valve" joint="{name}" gear="{gear}"/></actuator>
</mujoco>
"""
"""A valve that lets oil through in proportion is a force with a damper beside it. As the damper is
the valve, friction is no cause here: dry friction would be its dead band by another name."""

TOML = """schema = 1
kind = "rig"
name = "{name}"
model = "{name}.xml"
rate = 40
[clock]
column = "t"
[signals.duty]               # per cent from the neutral, as a force
columns = ["u"]
unit = "N"
[signals.length]
columns = ["x"]
unit = "m"
noise = "0.2 mm"             # the potentiometer's counts
[drive]
mode = "control"
lead = "0.3 s"               # the longest delay that is offered
actuators = {{ valve = "duty" }}
joints = {{ {name} = "length" }}
smoothing = "4 Hz"
[compare.length]
joint = "{name}"
[start.{name}]
position = "measured"
[typical.joint.{name}]         # read off the recordings
effort = 1.8                 # 2.5 % of duty
speed = "2 cm/s"
travel = "5 cm"
[[effects]]
kind = "actuator_delay"
on = ["valve"]
largest = "0.3 s"
[[effects]]                  # outside a dead band a line is much steeper than one through all
kind = "actuator_gain"
on = ["valve"]
largest = 7
[[effects]]
kind = "actuator_deadband"
on = ["valve"]
largest = 1.8
"""

KINDS = ("offset", "asymmetry", "saturation")


def sets(data: Path, folder: Path) -> list[Set]:
    """One manual run fitted, another one held out, of each axis."""
    return [_set(axis, data / "rc_hydraulic_excavator", folder) for axis in AXES]


def _set(axis: Axis, here: Path, folder: Path) -> Set:
    told = TOML.format(name=axis.name)
    told += effects(*((f"actuator_{kind}", ["valve"]) for kind in KINDS))
    model = MODEL.format(name=axis.name, gear=axis.gear)
    rig = machine(folder / axis.name, axis.name, model, told)
    fitted, held = (
        [read(rig, path) for path in pieces(axis, here / f"manual_1102_{log}.csv", folder)]
        for log in (1829, 1834)
    )
    name = f"excavator, {axis.name}"
    return Set(name, rig, fitted, held, axis.expert, axis.asked, over_windows)


def pieces(axis: Axis, log: Path, folder: Path) -> list[Path]:
    """Duty from its neutral, and length of the cylinder in SI, on even rows, piece by piece."""
    table = np.genfromtxt(log, delimiter=",", skip_header=1)
    time = np.arange(table[0, 0], table[-1, 0], PERIOD)
    duty = np.interp(time, table[:, 0], table[:, axis.duty]) - axis.neutral
    length = 0.01 * np.interp(time, table[:, 0], table[:, axis.length])
    found = []
    for first in range(WINDOW, len(time) - WINDOW, WINDOW):
        rows = slice(first - LEAD, first + WINDOW)
        path = folder / axis.name / f"{log.stem}_{first:04d}.csv"
        columns = np.column_stack([PERIOD * np.arange(LEAD + WINDOW), duty[rows], length[rows]])
        np.savetxt(path, columns, "%.9g", ",", header="t,u,x", comments="")
        found.append(path)
    return found


def over_windows(rig: Rig, recordings: Sequence[Recording]) -> str:
    """Rms error of the length over windows, each from the length at its begin."""
    forward, errors = MjcfForward.of(rig), []
    for recording in recordings:
        fed = Excitation.of(recording, forward.drive, rate=rig.description.rate)
        off = recording["length"][:, 0] - forward.simulate(fed, {})[:, 0]
        errors.append(off[LEAD:] - off[LEAD])
    return f"{100.0 * np.sqrt(np.mean(np.square(errors))):.3f} cm"
