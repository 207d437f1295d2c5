"""Excavator: duty of a valve to length of the boom's cylinder, in open loop from where it is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from real.machine import Set, effects, machine, read
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

NEUTRAL = 7.474
"""Duty at rest [%], on the data's page."""

PERIOD, WINDOW, LEAD = 0.025, 120, 12
"""Of the rows [s]; rows of a window, which is fitted, and told, from where the boom was measured: a
diagnosis asks for a hundred, and 3 s of the log have sixty; rows before it, which tell commands."""

MODEL = """<mujoco model="boom">
  <option timestep="0.01" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="rod"><joint name="boom" type="slide" axis="1 0 0" damping="100"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
  </worldbody>
  <actuator><motor name="valve" joint="boom" gear="0.72"/></actuator>
</mujoco>
"""
"""A valve that lets oil through in proportion is a force with a damper beside it: 0.72 cm/s for a
per cent of duty, a line through the origin and the fitted recording. As the damper is the valve,
friction is no cause here: dry friction would be its dead band by another name."""

TOML = """schema = 1
kind = "rig"
name = "boom"
model = "boom.xml"
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
actuators = { valve = "duty" }
joints = { boom = "length" }
smoothing = "4 Hz"
[compare.length]
joint = "boom"
[start.boom]
position = "measured"
[typical.joint.boom]         # read off the recordings
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
    """One manual run fitted, another one held out."""
    told = TOML + effects(*((f"actuator_{kind}", ["valve"]) for kind in KINDS))
    rig = machine(folder, "boom", MODEL, told)
    here = data / "rc_hydraulic_excavator"
    fitted, held = (
        [read(rig, path) for path in pieces(here / f"manual_1102_{log}.csv", folder)]
        for log in (1829, 1834)
    )
    asked = "<= 0.078 cm; dead band, asymmetry, delay named"
    return [Set("excavator, boom", rig, fitted, held, "0.078 cm", asked, over_windows)]


def pieces(log: Path, folder: Path) -> list[Path]:
    """Duty from its neutral, and length of the boom in SI, on even rows, piece by piece."""
    table = np.genfromtxt(log, delimiter=",", skip_header=1)
    time = np.arange(table[0, 0], table[-1, 0], PERIOD)
    duty = np.interp(time, table[:, 0], table[:, 1]) - NEUTRAL
    length = 0.01 * np.interp(time, table[:, 0], table[:, 5])
    found = []
    for first in range(WINDOW, len(time) - WINDOW, WINDOW):
        rows = slice(first - LEAD, first + WINDOW)
        path = folder / f"{log.stem}_{first:04d}.csv"
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
