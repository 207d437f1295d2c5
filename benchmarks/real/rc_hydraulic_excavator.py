"""Excavator: duty of a valve to speed of the boom's cylinder; length told over 3 s, open loop."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.signal import savgol_filter

from real.machine import Set, effects, machine, read
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.forward import Excitation
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig

NEUTRAL = 7.474
"""Duty at rest [%], on the data's page."""

PERIOD, WINDOW, SMOOTH = 0.05, 3.0, 7
"""Of the rows and of a window [s]; rows of the parabola that tells speed: a count of 0.37 mm is
1 mm/s then."""

MODEL = """<mujoco model="boom">
  <option timestep="0.01" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="rod"><joint name="boom" type="slide" axis="1 0 0" damping="100"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
  </worldbody>
  <actuator><motor name="valve" joint="boom" gear="0.72"/></actuator>
  <sensor><jointvel name="speed" joint="boom"/></sensor>
</mujoco>
"""
"""A valve that lets oil through in proportion is a force with a damper beside it: 0.72 cm/s for a
per cent of duty, a line through the origin and the fitted recording. As the damper is the valve,
friction is no cause here: dry friction would be its dead band by another name."""

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
[signals.speed]
columns = ["v"]
unit = "m/s"
noise = "1 mm/s"
[drive]
mode = "control"
actuators = { valve = "duty" }
[compare.speed]
sensor = "speed"
[typical.joint.boom]         # read off the recordings
effort = 1.8                 # 2.5 % of duty
speed = "2 cm/s"
travel = "5 cm"
[typical.signal.speed]
span = "2 cm/s"
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
    fitted, held = (
        [read(rig, even(data / "rc_hydraulic_excavator" / f"manual_1102_{log}.csv", folder))]
        for log in (1829, 1834)
    )
    asked = "<= 0.078 cm; dead band, asymmetry, delay named"
    return [Set("excavator, boom", rig, fitted, held, "0.078 cm", asked, over_windows)]


def even(log: Path, folder: Path) -> Path:
    """Duty from its neutral, length and speed of the boom on even rows, in SI."""
    table = np.genfromtxt(log, delimiter=",", skip_header=1)
    time = np.arange(table[0, 0], table[-1, 0], PERIOD)
    duty = np.interp(time, table[:, 0], table[:, 1]) - NEUTRAL
    length = 0.01 * np.interp(time, table[:, 0], table[:, 5])
    speed = savgol_filter(length, SMOOTH, 2, deriv=1, delta=PERIOD)
    path = folder / log.name
    columns = np.column_stack([time - time[0], duty, length, speed])
    np.savetxt(path, columns, "%.9g", ",", header="t,u,x,v", comments="")
    return path


def over_windows(rig: Rig, recordings: Sequence[Recording]) -> str:
    """Rms error of the length that a speed comes to, each window from the length at its begin."""
    forward, count, errors = MjcfForward.of(rig), round(WINDOW / PERIOD), []
    for recording in recordings:
        fed = Excitation.of(recording, forward.drive, rate=rig.description.rate)
        speed = forward.simulate(fed, {})[:, 0]
        path = np.concatenate([[0.0], np.cumsum(speed[:-1]) * fed.period])
        off = recording["length"][:, 0] - path
        for first in range(0, len(off) - count, count):
            errors.append(off[first : first + count] - off[first])
    return f"{100.0 * np.sqrt(np.mean(np.square(errors))):.3f} cm"
