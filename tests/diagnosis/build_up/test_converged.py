"""Causes that bend each other's columns: a fit goes on until new columns no longer help."""

from __future__ import annotations

import numpy as np
import pytest

from ves_twin.diagnosis.build_up.converged import converged
from ves_twin.diagnosis.evidence import Evidence
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.refine import refine
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.whitening import whitening_declared
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig

MODEL = """<mujoco><option timestep="0.01" gravity="0 0 0" integrator="RK4"/>
  <worldbody><body name="mass"><joint name="y" type="slide" stiffness="40" damping="0.4"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
  <actuator><motor name="drive" joint="y"/></actuator></mujoco>"""

DESCRIPTION = """schema = 1
kind = "rig"
name = "oscillator"
model = "oscillator.xml"
rate = 50
[clock]
column = "t"
[signals.u]
columns = ["u"]
unit = "N"
[signals.y]
columns = ["y"]
unit = "m"
noise = 1e-3
[drive]
mode = "control"
actuators = { drive = "u" }
[compare.y]
joint = "y"
[typical.joint.y]
effort = 10
speed = 2
travel = 0.5
[typical.signal.y]
span = 0.5
[[parameters]]
body = "mass"
attribute = "mass"
sd = 0.1
[[parameters]]
joint = "y"
attribute = "stiffness"
sd = 4
[[effects]]
kind = "cubic_spring"
on = ["y"]
[[effects]]
kind = "force_offset"
on = ["y"]
[[effects]]
kind = "sensor_offset"
on = ["y.1"]
"""

HIDDEN = {
    "cubic_spring@y:stiffness": 40.0,
    "force_offset@y:offset": 1.0,
    "sensor_offset@y.1:offset": 0.02,
    "joint_spring@y:stiffness": -6.0,
    "body_mass@mass:mass": 0.12,
}


def truth(runs: Runs) -> np.ndarray:
    """Departures of the hidden oscillator."""
    return np.array([HIDDEN.get(axis.parameter.name, 0.0) for axis in runs.coordinates])


@pytest.fixture(scope="module")
def evidence(tmp_path_factory):
    folder = tmp_path_factory.mktemp("oscillator")
    (folder / "oscillator.xml").write_text(MODEL)
    (folder / "oscillator.toml").write_text(DESCRIPTION)
    forward = MjcfForward.of(Rig.load(str(folder / "oscillator.toml")))
    rng = np.random.default_rng(1)
    time = 0.01 * np.arange(2500)
    phases = rng.uniform(0.0, 2.0 * np.pi, 30)
    tones = np.cos(2.0 * np.pi * np.outer(time, np.linspace(0.2, 2.5, 30)) + phases)
    fed = Excitation("tones", time, {"u": 0.8 * tones.sum(axis=1, keepdims=True)}, rate=50.0)
    runs = Runs(forward, (fed,), (0,))
    measured = runs.one(truth(runs))
    measured = measured + 1e-3 * rng.standard_normal(measured.shape).astype(np.float32)
    return Evidence(runs, measured, whitening_declared(runs))


def test_a_fit_goes_on_where_a_search_stopped_short(evidence):
    runs, causes = evidence.runs, evidence.runs.forward.hypotheses
    start = runs.origin
    for cause in causes:
        start = runs.depart(start, runs.indices(cause), 0.001 * np.array(cause.largest))
    once = refine(evidence, causes, start, linearise(runs, runs.origin), 1)
    found = converged(evidence, causes, runs.origin, start)
    true = evidence.whitening.apply(evidence.measured - runs.one(truth(runs)))
    assert once.chi2 > 2.0 * float(true @ true)  # else this test shows nothing
    assert found.chi2 < 1.05 * float(true @ true)
    sizes = dict(zip((n for h in causes for n in h.parameters), found.sizes, strict=True))
    assert sizes["cubic_spring@y:stiffness"] == pytest.approx(40.0, rel=0.05)
