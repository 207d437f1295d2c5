"""Excavator: duty of a valve to length of the boom's cylinder, in open-loop windows of 3 s."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from real.machine import Set, effects, machine, read

NEUTRAL = 7.474
"""Duty at rest [%], on the data's page."""

PERIOD, WINDOW = 0.05, 3.0
"""Of the rows, and of a window [s]."""

MOVED = 0.5
"""Duty that changes by less [%] over a window leaves the boom where it is: nothing to be fitted."""

MODEL = """<mujoco model="boom">
  <option timestep="0.01" gravity="0 0 0" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="rod"><joint name="boom" type="slide" axis="1 0 0" damping="100"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
  </worldbody>
  <actuator><motor name="valve" joint="boom" gear="0.7"/></actuator>
</mujoco>
"""
"""A valve that lets oil through in proportion is a force with a damper beside it: 0.7 cm/s for a
per cent of duty, a line through the origin and the fitted recording."""

TOML = """schema = 1
kind = "rig"
name = "boom"
model = "boom.xml"
rate = 10
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
actuators = { valve = "duty" }
joints = { boom = "length" }
smoothing = "4 Hz"
[compare.length]
joint = "boom"
[start.boom]
position = "measured"
sd = "0.2 mm"
speed_sd = "2 mm/s"
[typical.joint.boom]         # read off the recordings
effort = 1.75                # 2.5 % of duty
speed = "2 cm/s"
travel = "5 cm"
[typical.signal.length]
span = "5 cm"
"""


def sets(data: Path, folder: Path) -> list[Set]:
    """Windows of one manual run in which the boom moves fitted, all of another one held out."""
    kinds = ("gain", "offset", "deadband", "asymmetry", "saturation")
    told = TOML + effects(
        *((f"actuator_{kind}", ["valve"]) for kind in kinds),
        ("viscous_friction", ["boom"]),
        ("coulomb_friction", ["boom"]),
    )
    told += '\n[[effects]]\nkind = "actuator_delay"\non = ["valve"]\nlargest = "0.3 s"\n'
    rig = machine(folder, "boom", MODEL, told)
    fitted, held = (
        [read(rig, path) for path in windows(data / "rc_hydraulic_excavator" / log, folder, least)]
        for log, least in (("manual_1102_1829.csv", MOVED), ("manual_1102_1834.csv", 0.0))
    )
    asked = "<= 0.078 cm; dead band, asymmetry, delay named"
    return [Set("excavator, boom", rig, fitted, held, "0.078 cm", asked)]


def windows(log: Path, folder: Path, least: float) -> list[Path]:
    """Windows of a log on even rows, in SI, in which duty changes by so much at least."""
    table = np.genfromtxt(log, delimiter=",", skip_header=1)
    time = np.arange(table[0, 0], table[-1, 0], PERIOD)
    duty = np.interp(time, table[:, 0], table[:, 1]) - NEUTRAL
    length = 0.01 * np.interp(time, table[:, 0], table[:, 5])
    count = round(WINDOW / PERIOD)
    found = []
    for k in range(0, len(time) - count, count):
        rows = slice(k, k + count)
        if np.ptp(duty[rows]) < least:
            continue
        path = folder / f"{log.stem}_{k:04d}.csv"
        columns = np.column_stack([PERIOD * np.arange(count), duty[rows], length[rows]])
        np.savetxt(path, columns, "%.9g", ",", header="t,u,x", comments="")
        found.append(path)
    return found
