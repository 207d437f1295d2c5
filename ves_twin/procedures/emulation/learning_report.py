"""write_report: convergence, motion and losses of the Learning Method as tables and a picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import JsonValue

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.procedures.emulation.agreement_picture import write_agreement
from ves_twin.procedures.number_table import write_table
from ves_twin.procedures.procedure import Result
from ves_twin.report.picture import save_picture
from ves_twin.simulator.outcome import Outcome

AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class Iteration:
    """One iteration; rows are the cycles of the full-speed motion.

    Attributes:
        motion: Y^i, measured at full speed [m, rad] (n, 6).
        change: Y^i less what phase A ran, Y^(i-1) (n, 6).
        wrenches: W_g^i, sensor axes [N, N m] (n, 6).
        path_error: where phase A was, by its leg lengths, less where it should be (n, 6).
        joint_error: measured joint angles of phase A less those of phase B [rad] (n, 3).
        run: recording of phase B.
    """

    motion: FloatArray
    change: FloatArray
    wrenches: FloatArray
    path_error: FloatArray
    joint_error: FloatArray
    run: Recording

    @property
    def largest_change(self) -> tuple[float, float]:
        """Largest change of a translation [m] and of a rotation [rad], over axes and time."""
        return _largest(self.change)


@dataclass(frozen=True)
class Learned:
    """What the iterations came to.

    Attributes:
        iterations: those that were completed.
        start: pose at the start [m, rad] (6,).
        period: of the cycles [s].
        rig_time: of one iteration as the thesis counts it, (alpha + 1) times the motion [s].
        outcome: how the last one ended.
        settled: changes [m], [rad] below which the motion counts as found.
        exact: the experiment with gravity known exactly, without noise; None if it was not run.
        model: the experiment with the scenario's own gravity method; None if it was not run.
    """

    iterations: tuple[Iteration, ...]
    start: FloatArray
    period: float
    rig_time: float
    outcome: Outcome
    settled: tuple[float, float]
    exact: Recording | None
    model: Recording | None

    @property
    def settled_after(self) -> int | None:
        """The first iteration from which on every change is below the limits."""
        small = [
            one.largest_change[0] < self.settled[0] and one.largest_change[1] < self.settled[1]
            for one in self.iterations
        ]
        if not small or not small[-1]:
            return None
        return 1 + max((k + 1 for k, below in enumerate(small) if not below), default=0)


def result_of(learned: Learned) -> Result:
    """Numbers for the summary and lines for a person."""
    lines = [f"  {'iteration':<11}{'largest change':>24}{'phase A off its path':>26}"]
    lines.append(f"  {'':<11}{'mm':>12}{'mrad':>12}{'mm':>14}{'mrad':>12}")
    rows: list[JsonValue] = []
    for number, one in enumerate(learned.iterations, 1):
        (moved, turned), (off, off_angle) = one.largest_change, _largest(one.path_error)
        lines.append(
            f"  {number:<11}{moved * 1e3:12.3f}{turned * 1e3:12.3f}"
            f"{off * 1e3:14.3f}{off_angle * 1e3:12.3f}"
        )
        rows.append(
            {
                "translation": moved,
                "rotation": turned,
                "path_error_translation": off,
                "path_error_rotation": off_angle,
                "joint_error": float(np.max(np.abs(one.joint_error))),
            }
        )
    count = len(learned.iterations)
    minutes = count * learned.rig_time / 60.0
    values: dict[str, JsonValue] = {
        "iterations": rows,
        "settled_after": learned.settled_after,
        "rig_time": count * learned.rig_time,
    }
    lines += ["", f"  rig time  {count} x {learned.rig_time:.0f} s = {minutes:.0f} min"]
    lines.append(f"  {_verdict(learned)}")
    if count:
        lines += _losses(learned, values)
    return Result(learned.outcome, values, tuple(lines))


def _verdict(learned: Learned) -> str:
    limits = f"{learned.settled[0] * 1e3:g} mm and {learned.settled[1] * 1e3:g} mrad"
    if learned.outcome is not Outcome.COMPLETED:
        return f"ended in iteration {len(learned.iterations) + 1}: {learned.outcome.advice}"
    if learned.settled_after is not None:
        return f"settled: changes below {limits} from iteration {learned.settled_after} on"
    last = learned.iterations[-1].largest_change
    return (
        f"not settled: the last change, {last[0] * 1e3:.2f} mm and {last[1] * 1e3:.2f} mrad, is not"
        f" below {limits}; what does not repeat from phase to phase is not learned"
    )


def _losses(learned: Learned, values: dict[str, JsonValue]) -> list[str]:
    """The last motion beside the zero-g reference, and beside gravity known exactly."""
    run = learned.iterations[-1].run
    head = f"  {'last motion, rms [mm, mrad]':<34}" + "".join(f"{axis:>9}" for axis in AXES)
    rows = {"error against zero-g": rms_difference(run, "truth.pose", run, "reference.pose")}
    rows["  legs' bandwidth alone"] = rms_difference(
        run, "reference.pose_leg_lag", run, "reference.pose"
    )
    if learned.exact is not None and learned.model is not None:
        lost, lost_by_model = (
            rms_difference(one, "truth.pose", learned.exact, "truth.pose")
            for one in (run, learned.model)
        )
        rows["lost against gravity known exactly"] = lost
        rows["  the same by the Model Method"] = lost_by_model
        rows["Learning less Model Method"] = rms_difference(
            run, "truth.pose", learned.model, "truth.pose"
        )
        rows["  predicted by the two losses"] = np.hypot(lost, lost_by_model)
    lines = ["", head]
    for name, row in rows.items():
        lines.append(f"  {name:<34}" + "".join(f"{v * 1e3:9.3f}" for v in row))
        values[name.strip().replace(" ", "_").replace("'", "")] = row.tolist()
    return lines


def rms_difference(one: Recording, name: str, two: Recording, other: str) -> FloatArray:
    """Rms over the rows that both have of a signal of one run less a signal of another (6,)."""
    rows = min(len(one), len(two))
    return np.asarray(np.sqrt(np.mean((one[name][:rows] - two[other][:rows]) ** 2, axis=0)))


def write_report(learned: Learned, folder: Path) -> None:
    """Write tables and pictures of the iterations; nothing if there was none."""
    if not learned.iterations:
        return
    changes = np.array([np.max(np.abs(one.change), axis=0) for one in learned.iterations])
    units = ("m", "m", "m", "rad", "rad", "rad")
    heads = [f"{axis} [{unit}]" for axis, unit in zip(AXES, units, strict=True)]
    numbers: FloatArray = np.arange(1.0, len(changes) + 1)
    columns = dict(zip(heads, changes.T, strict=True))
    write_table(folder / "convergence.csv", {"iteration": numbers, **columns})
    last = learned.iterations[-1]
    time: FloatArray = np.arange(float(len(last.motion))) * learned.period
    columns = dict(zip(heads, last.motion.T, strict=True))
    write_table(folder / "motion.csv", {"t [s]": time, **columns})
    _picture(learned, time, folder / "convergence.png")
    if learned.model is not None:
        write_agreement(last.run, learned.model, folder / "agreement.png")


def _picture(learned: Learned, time: FloatArray, path: Path) -> None:
    from matplotlib import colormaps  # slow to import
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    FigureCanvasAgg(figure)
    left, middle, right = figure.subplots(1, 3)
    count = len(learned.iterations)
    for axes, k in ((left, 3), (middle, 5)):
        for number, one in enumerate(learned.iterations, 1):
            colour = colormaps["viridis"](number / (count + 1))
            axes.plot(time, one.motion[:, k] * 1e3, color=colour, lw=0.9, label=f"{number}")
        last = learned.iterations[-1].run
        axes.plot(last.time, last["reference.pose"][:, k] * 1e3, "k--", lw=0.8, label="zero-g")
        axes.set_ylabel(f"rotation about {AXES[k][1].upper()} [mrad]")
        axes.set_xlabel("time [s]")
    left.legend(fontsize=6, ncols=2)
    changes = np.array([one.largest_change for one in learned.iterations]) * 1e3
    numbers = np.arange(1, count + 1)
    right.semilogy(numbers, changes[:, 0], "o-", label="translation [mm]")
    right.semilogy(numbers, changes[:, 1], "s-", label="rotation [mrad]")
    right.axhline(1.0, color="k", lw=0.8, ls="--")
    right.set_xlabel("iteration")
    right.set_ylabel("largest change")
    right.legend(fontsize=8)
    for axes in (left, middle, right):
        axes.grid(alpha=0.3)
    save_picture(figure, path, 100)


def _largest(poses: FloatArray) -> tuple[float, float]:
    return float(np.max(np.abs(poses[:, :3]))), float(np.max(np.abs(poses[:, 3:])))
