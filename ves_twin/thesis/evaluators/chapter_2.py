"""CHAPTER_2: the machine, its clocks, its safety rules."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.signal import cont2discrete

from ves_twin.control.arm_servo import spline
from ves_twin.core.signals import SIGNALS
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.kinematics.rotations import matrix_from_angles
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.clock import Clock
from ves_twin.simulator.outcome import Outcome
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Answer, Evaluation, NotTestable
from ves_twin.thesis.standing_rig import StandingRig

BEAM = "beam_horizontal_truth"
GRAVITY = {"admittance": "none", "micro_gravity": "truth"}
"""Modes of the thesis that emulate, not those of plugins. In admittance mode nothing is subtracted:
the payload's weight is tared instead."""

WHOLE_TICKS = "every clock is a whole number of 341 us ticks"


def _freedoms(context: Context, claim: Claim) -> Evaluation:
    rig = StandingRig.of(context.plant)
    legs, axes = len(rig.layout.leg_ctrl), SIGNALS["sensor.wrench"].width
    return Evaluation((legs, axes), note="legs driven in the model, axes of the sensor's signal")


def _modes(context: Context, claim: Claim) -> Evaluation:
    short = {"run.duration": 0.3, "run.settle": 0.3}
    runs = [context.run("position_sine", short)]
    runs += [
        context.run(BEAM, {**short, "platform.mode": mode, "gravity.method": GRAVITY[mode]})
        for mode in GRAVITY
    ]
    done = all(run.recording.info.outcome == Outcome.COMPLETED for run in runs)
    names = ", ".join(("position", *GRAVITY))
    note = f"each of {names} ran for 0.3 s" if done else "one of them did not run to its end"
    return Evaluation(
        holds=done and len(runs) == 3, note=note, runs=tuple(run.command for run in runs)
    )


def _convention(context: Context, claim: Claim) -> Evaluation:
    gravity = context.plant.parameters.number("gravity")
    worst = 0.0
    for x, y, z in np.random.default_rng(3).uniform(-0.5, 0.5, (50, 3)):
        in_top = matrix_from_angles(np.array([x, y, z])).T @ np.array([0.0, 0.0, -gravity])
        row = [np.sin(y), -np.sin(x) * np.cos(y), -np.cos(x) * np.cos(y)]
        worst = max(worst, float(np.max(np.abs(in_top - gravity * np.array(row)))))
    return Evaluation((worst,), note="R' (0, 0, -g) against eq 3.4, 50 attitudes")


def _discrete(context: Context, claim: Claim) -> Evaluation:
    system, period = EmulatedSystem.load("beam_horizontal_thesis"), 1.0 / 80.0
    inverse = np.linalg.inv(system.mass)
    zero, one = np.zeros((6, 6)), np.eye(6)
    a = np.block([[zero, one], [-inverse @ system.stiffness, -inverse @ system.damping]])
    b = np.vstack([zero, inverse])
    phi, gamma, *_ = cont2discrete((a, b, np.eye(12), np.zeros((12, 6))), period, "zoh")
    ours = system.discretise(period)
    worst = max(float(np.max(np.abs(x - y))) for x, y in zip(ours, (phi, gamma), strict=True))
    return Evaluation((worst,), note="horizontal beam at 80 Hz against scipy, any entry")


def _clock(context: Context, rate: float = 80.0) -> Clock:
    return Clock.of(Scenario.load(BEAM, {"platform.rate": rate}), context.plant.parameters)


def _command_rate(context: Context, claim: Claim) -> Evaluation:
    return Evaluation((_clock(context).rate,), note="beam model; the text also has 75 to 90")


def _leg_rate(context: Context, claim: Claim) -> Evaluation:
    clock = _clock(context)
    return Evaluation((1.0 / (clock.leg * clock.tick),), note="the rate with the filter installed")


def _amplifiers(context: Context, claim: Claim) -> Evaluation:
    clock = _clock(context)
    return Evaluation(
        (1.0 / (clock.amplifier * clock.tick),),
        note=f"{clock.amplifier} ticks, the nearest to 1 ms: {WHOLE_TICKS}",
    )


def _tick(context: Context, claim: Claim) -> Evaluation:
    return Evaluation((_clock(context).tick * 1e6,), note="milliseconds in the print (E-5)")


def model_rates(context: Context) -> tuple[float, ...]:
    """Admittance rates [Hz] of the decoupled, beam and coupled model as the clock gives them."""
    return tuple(_clock(context, rate).rate for rate in (85.0, 80.0, 75.0))


def _admittance_rates(context: Context, claim: Claim) -> Evaluation:
    return Evaluation(model_rates(context), note="set to 85, 80, 75")


def _overrun(context: Context, claim: Claim) -> Evaluation:
    run = context.run(BEAM, {"run.duration": 1.0, "platform.rate": 95.0})
    info = run.recording.info
    said = info.events[-1].message if info.events else ""
    halted = info.outcome == Outcome.OVERRUN and len(run.recording) == 0
    return Evaluation(
        holds=halted, note=f"at 95 Hz {said}: {info.outcome} before any motion", runs=(run.command,)
    )


def _terms(context: Context, claim: Claim) -> Evaluation:
    phi, gamma = EmulatedSystem.load("beam_bent_thesis").discretise(1.0 / 80.0)
    full = np.hstack([phi, gamma])
    state = np.random.default_rng(2).normal(size=18)
    sparse = sum(full[:, j] * state[j] * (full[:, j] != 0.0) for j in range(18))
    same = bool(np.allclose(full @ state, sparse, rtol=0.0, atol=1e-12))
    share = 100.0 * np.count_nonzero(full) / full.size
    return Evaluation(
        (share,),
        holds=same,
        note="bent beam, Phi and Gamma; without the zeros the step is the same; a straight beam"
        " uses 28 %",
    )


def _margin(context: Context, claim: Claim) -> Evaluation:
    changes: dict[str, object] = {
        "run.duration": 4.0,
        "platform.motion.amplitude": [0.0, 0.0, 0.4, 0.0, 0.0, 0.0],
    }
    run = context.run("position_sine", changes)
    number = context.plant.parameters.number
    travel = number("leg.stroke") / 2.0 - number("leg.margin")
    home = context.plant.geometry.lengths(np.zeros(6))
    moved = np.max(np.abs(run.recording["leg.length"] - home), axis=0)
    return Evaluation(
        (float(np.count_nonzero(moved > travel)),),
        holds=run.recording.info.outcome == Outcome.LEG_LIMIT,
        note=f"heave of 0.4 m asked; halted ({run.recording.info.outcome}), legs went"
        f" {np.max(moved):.3f} of {travel:.3f} m",
        runs=(run.command,),
    )


def _look_ahead(context: Context, claim: Claim) -> Evaluation:
    ahead = 0
    for point in (2, 3):  # commands k + 1 and k + 2 of k - 1 ... k + 2
        points, q, rate = np.zeros((4, 3)), np.zeros(3), np.zeros(3)
        points[point] = 1.0
        spline(points, 0.5, 0.0125, q, rate)
        ahead += bool(np.any(q != 0.0))
    return Evaluation((ahead,), note="commands ahead that shape the path between two commands")


CHAPTER_2: Mapping[str, Answer] = {
    "C001": _freedoms,
    "C002": _modes,
    "C003": _convention,
    "C004": _discrete,
    "C005": _command_rate,
    "C006": _leg_rate,
    "C007": _amplifiers,
    "C008": _tick,
    "C009": _admittance_rates,
    "C010": _overrun,
    "C011": _terms,
    "C012": _margin,
    "C013": NotTestable("the arm has three joints; unused axes have nothing to simulate"),
    "C014": _look_ahead,
}
"""Claim -> answer."""
