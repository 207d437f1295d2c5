"""Causes that bend each other's columns: a fit goes on until new columns no longer help."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from linear import Linear, recorded, seen

from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.build_up.bench import STRAINED
from ves_twin.diagnosis.build_up.converged import _descended, converged
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

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
    time = 0.01 * np.arange(1500)
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


VALVE = """<mujoco><option timestep="0.01" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody><body name="rod"><joint name="y" type="slide" damping="100"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
  <actuator><motor name="drive" joint="y"/></actuator></mujoco>"""

CHAIN = """[[effects]]
kind = "actuator_gain"
on = ["drive"]
largest = 7
[[effects]]
kind = "actuator_offset"
on = ["drive"]
[[effects]]
kind = "actuator_deadband"
on = ["drive"]
largest = 1.8
[[effects]]
kind = "actuator_saturation"
on = ["drive"]
"""

HIDDEN_CHAIN = {
    "actuator_gain@drive:gain": 3.5,
    "actuator_offset@drive:offset": -0.2,
    "actuator_deadband@drive:band": 1.2,
    "actuator_saturation@drive:share": 0.9,
    "actuator_saturation@drive:limit": 0.55,
}
"""A dead band that most commands do not leave, and a valve that is soon open beyond it."""

STARTS = {
    "at the end of a share's range": (0.616, -0.174, 0.611, 1.0, 1.664),
    "a band of nothing": (5.6, 0.5, 0.072, 1.0, 2.5),
}
"""Gain, offset, band, share and limit: where fits of an excavator's valve ended, and began."""


@pytest.fixture(scope="module")
def valve(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valve")
    (folder / "oscillator.xml").write_text(VALVE)
    told = DESCRIPTION[: DESCRIPTION.index("[[parameters]]")].replace("effort = 10", "effort = 2.5")
    (folder / "oscillator.toml").write_text(told + CHAIN)
    forward = MjcfForward.of(Rig.load(str(folder / "oscillator.toml")))
    rng = np.random.default_rng(2)
    time, levels = 0.02 * np.arange(2000), rng.uniform(-3.0, 3.0, 80)
    pushes = np.interp(time, 0.5 * np.arange(80), levels)[:, None]
    runs = Runs(forward, (Excitation("pushes", time, {"u": pushes}, rate=50.0),), (0,))
    hidden = np.array([HIDDEN_CHAIN.get(axis.parameter.name, 0.0) for axis in runs.coordinates])
    measured = runs.one(hidden)
    measured = measured + 1e-3 * rng.standard_normal(measured.shape).astype(np.float32)
    return Evidence(runs, measured, whitening_declared(runs)), hidden


@pytest.mark.parametrize("start", STARTS)
def test_a_valve_is_found_from_where_a_step_cut_off_at_a_bound_ends(valve, start):
    evidence, hidden = valve
    runs = evidence.runs
    named = {h.effect: h for h in runs.forward.hypotheses}
    kinds = ("actuator_gain", "actuator_offset", "actuator_deadband", "actuator_saturation")
    causes = tuple(named[kind] for kind in kinds)
    where = np.concatenate([runs.indices(cause) for cause in causes])
    found = converged(evidence, causes, runs.origin, runs.depart(runs.origin, where, STARTS[start]))
    noise = evidence.whitening.apply(evidence.measured - runs.one(hidden))
    assert found.chi2 < 1.05 * float(noise @ noise)
    assert found.sizes == pytest.approx(hidden[where], rel=0.1)


@dataclass(frozen=True)
class Failing(ForwardWrapper):
    """A plant whose simulation breaks off at gains beyond 4.6; keeps which gains were asked."""

    asked: list[float]
    identity = "failing"

    def simulate(self, programme, values, refined=False):
        rows = self.forward.simulate(programme, values, refined)
        self.asked.append(values["actuator_gain@drive:gain"])
        return rows * np.nan if self.asked[-1] > 4.6 else rows


def test_steps_to_where_a_plant_fails_are_shortened(valve):
    evidence, hidden = valve
    asked = list[float]()
    broken = replace(evidence.runs, forward=Failing(evidence.runs.forward, asked))
    evidence = Evidence(broken, evidence.measured, whitening_declared(broken))
    gain, band = (
        next(h for h in broken.forward.hypotheses if h.effect == f"actuator_{kind}")
        for kind in ("gain", "deadband")
    )
    where = np.concatenate([broken.indices(gain), broken.indices(band)])
    there = broken.depart(hidden, where, (0.3, 0.4))
    fit = refine(evidence, (gain, band), there, linearise(broken, there), 0)
    left = evidence.whitening.apply(evidence.measured - broken.one(there))
    start = replace(fit, sizes=there[where], shift=there, chi2=float(left @ left))
    found = _descended(evidence, start)
    assert max(asked) > 4.6
    assert found[where] == pytest.approx(hidden[where], rel=0.05)


def test_a_tolerance_does_no_cause_s_work_in_a_full_fit():
    """A mass ten sd off is no tolerance: what is known to 5 % may be 25 % off at most."""
    plant = Linear(kinds=("viscous",))
    one = seen(plant, recorded(plant, {"mass": 1.5, "viscous@a:size": 0.6}, 5, error=0.01))
    runs = one.runs
    cause = next(h for h in plant.hypotheses if h.label == "viscous@a")
    evidence = Evidence(runs, one.measured, whitening_declared(runs))
    fit = converged(evidence, (cause,), runs.origin, runs.origin)
    (mass,) = runs.nuisances
    assert fit.shift[mass] == pytest.approx(STRAINED * runs.sd[mass])
