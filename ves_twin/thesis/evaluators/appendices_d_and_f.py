"""APPENDICES_D_AND_F: the sensor: where it is, its zero, its noise and its drift."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.mechanics.kinematics.wrenches import sensor_to_top
from ves_twin.plant.layout import Layout
from ves_twin.plant.physics.force_sensor import STATE, sample_wrench
from ves_twin.scenario.schema import Legs, Scenario
from ves_twin.simulator.blocks import parameter_block
from ves_twin.simulator.build import belief_of
from ves_twin.simulator.clock import Clock
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Answer, Evaluation, NotTestable
from ves_twin.thesis.standing_rig import StandingRig

STILL: dict[str, object] = {"platform.motion.amplitude": [0.0] * 6, "gravity.method": "truth"}


def _sensor_offset(context: Context, claim: Claim) -> Evaluation:
    rig = StandingRig.of(context.plant)
    position = rig.model.site("sensor/wrench").pos
    turn, worst = np.diag([1.0, -1.0, -1.0]), 0.0
    for wrench in np.random.default_rng(8).normal(0.0, 100.0, (50, 6)):
        force = turn @ wrench[:3]
        direct = np.concatenate([force, turn @ wrench[3:] + np.cross(position, force)])
        worst = max(worst, float(np.max(np.abs(sensor_to_top(wrench, position) - direct))))
    return Evaluation(
        tuple(map(float, position)),
        holds=worst < 1e-9,
        note=f"wrench carried to the top against R M + p x R F: {worst:.0e} N m",
    )


def _residual(context: Context, claim: Claim) -> Evaluation:
    changes = {**STILL, "run.duration": 1.0, "run.settle": 10.0}
    run = context.run("position_sine", changes)
    residual = run.recording["sensor.wrench"] - run.recording["gravity.estimate"]
    share = np.abs(np.mean(residual, axis=0)) / context.plant.parameters.array("sensor.noise")
    note = "largest of six axes, mean over the first second after zeroing for 10 s"
    return Evaluation((float(np.max(share)),), note=note, runs=(run.command,))


def _low_pass(context: Context, claim: Claim) -> Evaluation:
    """Corner of the sensor chain by its impulse response through the compiled kernel."""
    scenario = Scenario.load("position_sine")
    clock = Clock.of(scenario, context.plant.parameters)
    layout = Layout.of(StandingRig.of(context.plant).model)
    legs = Legs(filter=FilterPlace.NONE)
    block = parameter_block(context.plant, layout, clock, legs, belief_of(scenario))
    p, state = block[0]["sensor"], np.zeros(1, STATE)
    p["resolution"], p["offset"], p["drift"] = 0.0, 0.0, 0.0
    silent, count = np.zeros(6, np.float32), round(2.0 / clock.tick)
    impulse = np.zeros(count)
    for k in range(count):
        sample_wrench(p, state[0], np.full(6, 1.0 if k == 0 else 0.0), 0.0, silent)
        impulse[k] = state[0]["reading"][2]
    angle = 2.0 * np.pi * clock.tick
    low, high = 0.5, 400.0
    while high - low > 1e-6:  # the response of a Butterworth falls without ripple
        middle = 0.5 * (low + high)
        response = abs(np.sum(impulse * np.exp(-1j * angle * middle * np.arange(count))))
        low, high = (middle, high) if response > np.sqrt(0.5) * np.sum(impulse) else (low, middle)
    return Evaluation((low,), note="impulse response of the running chain; order assumed")


def _drift(context: Context, claim: Claim) -> Evaluation:
    sd = context.plant.parameters["sensor.drift"].sd
    changes = {
        **STILL,
        "run.duration": 20.0,
        "run.noise": False,
        "parameters.sensor.drift": [float(f"{3.0 * v:.3g}") for v in sd],
    }
    run = context.run("position_sine", changes)
    residual = run.recording["sensor.wrench"] - run.recording["gravity.estimate"]
    worst = float(np.max(np.abs(residual[:, :3])))
    hours = 3.0 * float(np.max(sd[:3])) * 8.0 * 3600.0
    note = f"the same drift makes {hours:.0f} N in 8 h without zeroing (size assumed)"
    return Evaluation((worst,), note=note, runs=(run.command,))


APPENDICES_D_AND_F: Mapping[str, Answer] = {
    "C115": _sensor_offset,
    "C122": _residual,
    "C129": _low_pass,
    "C130": NotTestable("the figure's data are lost; only its caption survives"),
    "C131": _drift,
}
"""Claim -> answer."""
