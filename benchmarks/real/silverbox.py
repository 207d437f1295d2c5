"""Silverbox: an electronic oscillator; voltage fed in open loop, displacement compared."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.signal import resample_poly

from real.machine import Set, effects, machine, read
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

RATE = 1e7 / 2**14
"""Of the recording [Hz]."""

FINER = 4
"""Rows for each recorded one: the input is a band-limited signal, a simulation holds a row."""

ARROW, TRAIN, PROOF = slice(0, 40_000), slice(41_000, 43_048), slice(58_000, 60_048)
"""Samples of the growing noise, by the data's page, and a quarter of two of the multisines behind
it: what the error is told on, what is fitted, and what proves it."""

MODEL = """<mujoco model="silverbox">
  <option timestep="4.096e-4" gravity="0 0 0" integrator="RK4"><flag contact="disable"/></option>
  <worldbody>
    <body name="mass"><joint name="y" type="slide" axis="1 0 0" stiffness="1.02" damping="2.3e-4"/>
      <inertial pos="0 0 0" mass="5.37e-6" diaginertia="1e-6 1e-6 1e-6"/></body>
  </worldbody>
  <actuator><motor name="input" joint="y"/></actuator>
</mujoco>
"""
"""Mass, damping and stiffness by a line through the inverse of the frequency response."""

TOML = f"""schema = 1
kind = "rig"
name = "silverbox"
model = "silverbox.xml"
about = "1 V of the input stands for 1 N, 1 V of the output for 1 m"
rate = {RATE}
[clock]
column = "t"
[signals.V1]
columns = ["u"]
unit = "N"
[signals.V2]
columns = ["y"]
unit = "m"
noise = 2e-4                 # two thirds of the best published error
[drive]
mode = "control"
actuators = {{ input = "V1" }}
joints = {{ y = "V2" }}
smoothing = "250 Hz"
[compare.V2]
joint = "y"
[start.y]
position = "measured"
sd = 1e-3
speed_sd = 0.5
[typical.joint.y]            # read off the recording
effort = 0.1
speed = 60
travel = 0.2
[typical.signal.V2]
span = 0.2
[[parameters]]
body = "mass"
attribute = "mass"
sd = 5e-7
[[parameters]]
joint = "y"
attribute = "damping"
sd = 5e-5
[[parameters]]
joint = "y"
attribute = "stiffness"
sd = 0.1
"""

KINDS = (
    "cubic_spring",
    "coulomb_friction",
    "quadratic_drag",
    "force_offset",
)


def sets(data: Path, folder: Path) -> list[Set]:
    """A quarter of a multisine fitted, one of another held out; told on the growing noise."""
    told = TOML + effects(
        *((kind, ["y"]) for kind in KINDS),
        ("actuator_delay", ["input"]),
        ("sensor_gain", ["V2.1"]),
        ("sensor_offset", ["V2.1"]),
    )
    rig = machine(folder, "silverbox", MODEL, told)
    table = np.genfromtxt(
        data / "silverbox" / "SNLS80mV.csv", delimiter=",", skip_header=1, usecols=(0, 1)
    )
    train, proof, arrow = (
        read(rig, _finer(table[rows], folder / f"{name}.csv"))
        for name, rows in (("train", TRAIN), ("proof", PROOF), ("arrow", ARROW))
    )
    asked = "cubic spring named, <= 1.71 mV"

    def error(extended: Rig, _: Sequence[Recording]) -> str:
        """Rms in free run over the growing noise."""
        forward = MjcfForward.of(extended)
        fed = Excitation.of(arrow, forward.drive, rate=RATE)
        off = arrow["V2"] - forward.simulate(fed, {})
        return f"{1e3 * float(np.sqrt(np.mean(np.square(off[::FINER])))):.2f} mV"

    return [Set("silverbox", rig, [train], [proof], "1.71 mV (0.3 published)", asked, error)]


def _finer(table: np.ndarray, path: Path) -> Path:
    """Columns t, u, y with FINER rows for one; u is that of the middle of the row it is held."""
    many = resample_poly(table, 2 * FINER, 1, axis=0)
    rows = np.column_stack([many[1::2, 0], many[::2, 1]])
    time = np.arange(len(rows)) / (FINER * RATE)
    np.savetxt(path, np.column_stack([time, rows]), "%.9g", ",", header="t,u,y", comments="")
    return path
