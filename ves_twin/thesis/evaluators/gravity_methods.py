"""GRAVITY_METHODS: mass parameters, identification, verification and the Learning Method."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from ves_twin.mechanics.gravity.gravity_model import gravity_in_top
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Result, RunContext
from ves_twin.procedures.registry import load_procedure
from ves_twin.simulator.outcome import Outcome
from ves_twin.thesis.claim import Claim
from ves_twin.thesis.context import Context
from ves_twin.thesis.evaluation import Answer, Evaluation, Evaluator, NotRun

CALIBRATION, VERIFICATION = "calibrate_47_poses", "verify_gravity_model"
NOISE = ("sensor.noise", "sensor.wander")
LEARNING, DROOP = "beam_learning_method", "frozen_platform_droop"

FAST = {"plant": "ves2_crosstalk_fast"}
"""Quick: the same rig with straight legs without bodies; its figures agree to some per cent."""


def _carried_out(context: Context, name: str, changes: Mapping[str, Any]) -> tuple[Result, str]:
    """A procedure in a folder that is thrown away, once, and the command that repeats it."""

    def make() -> Result:
        procedure = load_procedure(name, changes)
        assert procedure is not None  # noqa: S101  (the shipped file names one)
        plant = _retuned(context, changes.get("plant", procedure.plant))
        with TemporaryDirectory() as folder:
            return procedure.carry_out(RunContext(Path(folder), plant=plant))

    command = " ".join([f"ves-twin run {name}", *(f"--set {k}={v}" for k, v in changes.items())])
    account: Result = context.once(command, make)
    return account, command


def _retuned(context: Context, name: str) -> Plant | None:
    """A procedure's rig with the sensor's noise of one tuned without a claim; None as it stands."""
    told = {n: v for n, v in context.plant.changes().items() if n in NOISE}
    return Plant.load(name).with_values(told) if told else None


def _values(context: Context, name: str, changes: Mapping[str, Any]) -> tuple[Any, str]:
    account, command = _carried_out(context, name, changes)
    return account.values, command


def _learned(context: Context) -> tuple[Any, str]:
    """Nine iterations in `fast`."""
    return _values(context, LEARNING, {"plant": "ves2_fast"})


def _full_only(evaluator: Evaluator, takes: str) -> Evaluator:
    """An evaluator of what a shorter run would answer otherwise."""

    def evaluate(context: Context, claim: Claim) -> Evaluation | NotRun:
        return (
            NotRun(f"only the full run tells: {takes}")
            if context.quick
            else evaluator(context, claim)
        )

    return evaluate


NINE = "nine iterations of the 20 s motion; a short motion lets slow noise do less"
PARTS = "each part of the error alone on the slow sweep; a faster one shakes the rig"


def _parameter_count(context: Context, claim: Claim) -> Evaluation:
    basis = context.plant.gravity_model.basis
    links = len(basis.chain.joints) + 1
    note = f"rank of the columns of {3 * links} first moments and {links} masses"
    return Evaluation((float(len(basis.kept)),), note=note)


def _direct_sum(context: Context, claim: Claim) -> Evaluation:
    """G P against the sum of r x m g over the links, from frames and centres."""
    model = context.plant.gravity_model
    masses, centres = (context.plant.parameters.array(f"arm.{n}") for n in ("mass", "com"))
    generator = np.random.default_rng(34)
    q = generator.uniform(-np.pi, np.pi, (200, 3))
    g = gravity_in_top(generator.uniform(-0.5, 0.5, (200, 3)), model.gravity)
    frames = model.basis.chain.frames(q)
    points = np.einsum("nlij,lj->nli", frames[..., :3, :3], centres) + frames[..., :3, 3]
    direct = np.cross(np.einsum("l,nli->ni", masses, points), g)
    difference = model.basis.moment_regressor(q, g) @ model.moments - direct
    return Evaluation((float(np.max(np.abs(difference))),), note="200 random poses, three joints")


def _moments(context: Context, claim: Claim) -> Evaluation:
    values = tuple(map(float, context.plant.gravity_model.moments))
    return Evaluation(values, note="first moments reduced by the chain's own rank")


def _identified_moment(context: Context, claim: Claim) -> Evaluation:
    found, command = _calibrated(context)
    row = found["parameters"][3]  # M_total, then P1, P2, P3
    error = 100.0 * abs(row["value"] / row["truth"] - 1.0)
    note = f"P3 {row['value']:.3f} +- {row['half_width_90']:.3f} kg m, truth {row['truth']:.3f}"
    return Evaluation((error,), note=note, runs=(command,))


def _pose_count(context: Context, claim: Claim) -> Evaluation:
    procedure: Any = load_procedure(CALIBRATION)
    return Evaluation((float(procedure.poses.count),), note=f"poses of {CALIBRATION}")


def _passes(context: Context, claim: Claim) -> Evaluation:
    found, command = _calibrated(context)
    change = 100.0 * found["last_pass_changes_rms_by"]
    note = f"a third pass changes rms force or moment by {change:.1f} %; poses d-optimal"
    return Evaluation((2.0,), holds=change < 10.0, note=note, runs=(command,))


def _third_pass(context: Context, claim: Claim) -> Evaluation:
    found, command = _calibrated(context)
    change = 100.0 * found["last_pass_changes_rms_by"]
    return Evaluation((change,), note="of the rms force or moment, the larger", runs=(command,))


def _calibrated(context: Context) -> tuple[Any, str]:
    return _values(context, CALIBRATION, FAST if context.quick else {})


def _verified(context: Context) -> tuple[Any, str]:
    short = {"budget": "false"} if context.quick or context.plant.changes() else {}
    return _values(context, VERIFICATION, {**FAST, **short} if context.quick else short)


def _droop(context: Context, claim: Claim) -> Evaluation:
    found, command = _values(context, DROOP, FAST if context.quick else {})
    frozen, held = found["frozen"], found["position_control"]
    peaks = [max(frozen["peak"][axes]) for axes in (slice(3), slice(3, 6))]
    rms = [max(frozen["rms"][axes]) for axes in (slice(3), slice(3, 6))]
    floor = [max(held["peak"][axes]) for axes in (slice(3), slice(3, 6))]
    note = (
        f"largest over 47 poses after five passes, frozen platform, angles off by up to"
        f" {found['droop_max_deg']:.2f} deg (cause and size assumed); rms {rms[0]:.1f} N and"
        f" {rms[1]:.1f} N m; under control {floor[0]:.1f} N and {floor[1]:.1f} N m"
    )
    return Evaluation(tuple(map(float, peaks)), note=note, runs=(command,))


def _noise_share(context: Context, claim: Claim) -> Evaluation:
    """Mean square of the noise over that of all parts, each less what `nothing` leaves."""
    found, command = _verified(context)
    parts = {name: np.square(rms) for name, rms in found["budget_rms"].items()}
    rest = parts.pop("nothing")
    alone = {name: np.maximum(square - rest, 0.0) for name, square in parts.items()}
    total = rest + sum(alone.values())
    shares = [100.0 * sum(alone["noise"][k]) / sum(total[k]) for k in (slice(3), slice(3, 6))]
    least = 100.0 * alone["noise"] / total
    axis = int(np.argmin(least))
    note = (
        "mean squares of all forces, of all moments; the noise was set from Table 3-1. Least on"
        f" {found['axes'][axis]}: {least[axis]:.0f} %"
    )
    return Evaluation(tuple(map(float, shares)), note=note, runs=(command,))


def _tilt(context: Context, claim: Claim) -> Evaluation:
    procedure: Any = load_procedure(VERIFICATION)
    degrees = float(np.degrees(procedure.tilt))
    return Evaluation((-degrees, degrees), note=f"amplitude of {VERIFICATION}, a slow round")


def _table_3_1(axis: int, key: str) -> Evaluator:
    def evaluate(context: Context, claim: Claim) -> Evaluation:
        found, command = _verified(context)
        note = "identified model, slow sweep, sensor zeroed before; the noise was set from this"
        return Evaluation((float(found[key][axis]),), note=f"{note} table", runs=(command,))

    return evaluate


def _goal(context: Context, claim: Claim) -> Evaluation:
    found, command = _verified(context)
    rms, peak = found["rms"], found["max"]
    note = f"maxima {max(peak[:3]):.2f} N and {max(peak[3:]):.2f} N m exceed it, as printed (E-24)"
    return Evaluation((max(rms[:3]), max(rms[3:])), note=note, runs=(command,))


def _stretch(context: Context, claim: Claim) -> Evaluation:
    procedure: Any = load_procedure(LEARNING)
    return Evaluation((procedure.alpha,), note=f"alpha of {LEARNING}")


def _slow_speed(context: Context, claim: Claim) -> Evaluation:
    procedure: Any = load_procedure(LEARNING)
    return Evaluation((1.0 / procedure.alpha,), note=f"1 / alpha of {LEARNING}")


def _no_motion(context: Context, claim: Claim) -> Evaluation:
    procedure: Any = load_procedure(LEARNING)
    still = procedure.guess == "none"
    return Evaluation((0.0 if still else float("nan"),), note=f"guess of {LEARNING}: none")


def _iterations(context: Context, claim: Claim) -> Evaluation:
    found, command = _learned(context)
    after, count = found["settled_after"], len(found["iterations"])
    note = f"changes below 1 mm and 1 mrad {f'from {after} on' if after else f'not in {count}'}"
    return Evaluation(
        (float(after) if after else float(count + 1),),
        note=f"{note}; without noise eight of the 20 s motion (docs/microgravity.md)",
        runs=(command,),
    )


def _last_change(key: str, scale: float) -> Evaluator:
    def evaluate(context: Context, claim: Claim) -> Evaluation:
        found, command = _learned(context)
        note = "largest change of the last iteration, noise as assumed; its slow part stays in W_g"
        last = found["iterations"][-1][key]
        return Evaluation((scale * float(last),), note=note, runs=(command,))

    return evaluate


def _rig_time(context: Context, claim: Claim) -> Evaluation:
    procedure: Any = load_procedure(LEARNING)
    seconds = procedure.phases(RunContext(Path()), 0).scenario.run.duration
    minutes = procedure.iterations * (procedure.alpha + 1.0) * seconds / 60.0
    note = f"{procedure.iterations} iterations of {procedure.alpha + 1.0:g} x {seconds:g} s"
    return Evaluation((minutes,), note=note)


def _agreement(context: Context, claim: Claim) -> Evaluation:
    found, command = _learned(context)
    change = found["iterations"][0]["translation"]  # from no motion: the motion itself
    differs = float(np.max(found["Learning_less_Model_Method"][:3]))
    note = "largest rms of a translation, over the peak of the first motion; noise as assumed"
    return Evaluation((100.0 * differs / change,), note=note, runs=(command,))


def _abort(context: Context, claim: Claim) -> Evaluation:
    changes = {
        "plant": "ves2_fast",
        "experiment": "beam_horizontal_corrected",
        "duration": 2.0,
        "alpha": 10.0,
    }
    account, command = _carried_out(context, LEARNING, changes)
    note = f"an unstable model drives phase B out: {account.outcome}"
    stopped = account.outcome in (Outcome.LEG_LIMIT, Outcome.WRENCH_RANGE)
    return Evaluation(holds=stopped, note=note, runs=(command,))


GRAVITY_METHODS: Mapping[str, Answer] = {
    "C027": _stretch,
    "C028": _no_motion,
    "C029": _full_only(_iterations, NINE),
    "C030": _full_only(_last_change("translation", 1e3), NINE),
    "C031": _full_only(_last_change("rotation", 1.0), NINE),
    "C032": _abort,
    "C033": _parameter_count,
    "C034": _direct_sum,
    "C035": _droop,
    "C037": _pose_count,
    "C038": _passes,
    "C039": _third_pass,
    "C040": _tilt,
    **{
        f"C{41 + 2 * axis + k:03d}": _table_3_1(axis, key)
        for axis in range(6)
        for k, key in enumerate(("rms", "max"))
    },
    "C053": _goal,
    "C054": _slow_speed,
    "C055": _rig_time,
    "C056": _full_only(_agreement, NINE),
    "C113": _moments,
    "C114": _identified_moment,
    "C132": _full_only(_noise_share, PARTS),
}
"""Claim -> answer."""
