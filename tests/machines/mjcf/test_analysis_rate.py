"""The rate of the analysis where motion is fed in: no band in which efforts have what it lacks."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.grid import RATE
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import CORNER, RigDescription
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """<mujoco><option timestep="0.005" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody><body name="cart"><joint name="rail" type="slide" axis="1 0 0"/>
    <inertial pos="0 0 0" mass="5" diaginertia="1 1 1"/></body></worldbody>
  <actuator><motor name="drive" joint="rail"/></actuator></mujoco>"""

TOML = """name = "cart"
model = "cart.xml"
{rate}
clock = {{ column = "t" }}
drive = {{ mode = "{mode}", smoothing = 15{more} }}
[signals]
x = {{ columns = ["x"], unit = "m", joint = "rail", noise = 2e-5 }}
f = {{ columns = ["f"], unit = "N", actuator = "drive", noise = 2 }}
[typical.joint.rail]
effort = 60
speed = 0.3
travel = 0.1
[[effects]]
kind = "coulomb_friction"
on = ["rail"]
"""

FRICTION = 60.0
"""Of the cart [N]: half of what its acceleration asks."""

PERIOD = 0.005


def rig(folder: Path, rate: str = "", mode: str = "motion", more: str = "") -> Rig:
    (folder / "cart.xml").write_text(MODEL)
    (folder / "cart.toml").write_text(
        'schema = 1\nkind = "rig"\n' + TOML.format(rate=rate, mode=mode, more=more)
    )
    return Rig.load(str(folder / "cart.toml"))


def shaken() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, force and time of a cart on smooth tones and quick ramps, 20 s."""
    rng = np.random.default_rng(8)
    time = PERIOD * np.arange(4000)
    x = 0.03 * np.sin(2.0 * np.pi * np.outer(time, [0.31, 0.83, 1.7])).sum(axis=1)
    for begin in np.arange(2.0, 18.0, 3.0):
        x += 0.02 * (
            np.clip((time - begin) / 0.05, 0, 1) - np.clip((time - begin - 1.5) / 0.05, 0, 1)
        )
    v = np.gradient(x, PERIOD)
    f = 5.0 * np.gradient(v, PERIOD) + FRICTION * np.sign(v)
    noise = rng.standard_normal((2, len(time)))
    return x + 2e-5 * noise[0], f + 2.0 * noise[1], time


def left(rig: Rig) -> float:
    """What the true friction leaves of the force [N]."""
    x, f, time = shaken()
    fed = Excitation("shaken", time, {"x": x[:, None]}, rate=rig.description.rate)
    runs = Runs(MjcfForward.of(rig), (fed,), (0,))
    (at,) = runs.indices(runs.forward.hypotheses[0])
    there = runs.one(FRICTION * np.eye(len(runs.origin))[at])
    return float(np.sqrt(np.mean((runs.grids[0].reduce(f[:, None]) - there)[20:-20] ** 2)))


def test_efforts_are_compared_in_the_band_that_their_motion_still_has(tmp_path):
    """At 100 Hz most of what is left is what the motion's low-pass took from the model alone."""
    own, fast = left(rig(tmp_path)), left(rig(tmp_path, "rate = 100"))
    assert own < 0.3 * fast
    assert own < 0.06 * FRICTION  # what is left: reversals in which friction turns at once


@pytest.mark.parametrize(
    ("given", "rate"),
    [
        ({}, 2.0 * 15.0 / CORNER),
        ({"rate": "rate = 50"}, 50.0),
        ({"mode": "control"}, RATE),
        ({"mode": "control", "more": ', imposed = ["rail"]'}, 2.0 * 15.0 / CORNER),
    ],
    ids=["motion", "said", "control", "imposed"],
)
def test_the_rate_follows_from_the_low_pass_where_motion_is_fed_in(given, rate):
    text = {"rate": "", "mode": "motion", "more": "", **given}
    told = RigDescription.model_validate(tomllib.loads(TOML.format(**text)))
    assert told.rate == pytest.approx(rate)
