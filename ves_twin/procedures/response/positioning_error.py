"""PositioningErrorTest: the release of Table 5-2 at several leg settings (thesis fig. 5-11)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, final

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.scenario.fields import Seconds
from ves_twin.scenario.schema import Legs, Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import simulate

PICTURE = "positioning_error.png"
AXES = SIGNALS["truth.pose"].axes
_UNITS = ("mm", "mm", "mm", "mrad", "mrad", "mrad")


@dataclass(frozen=True)
class ReleaseError:
    """Positioning error of one release.

    Attributes:
        label: gain and filter place.
        outcome: how the run ended.
        time: [s] (n,).
        error: commanded less true pose at the same instant [m, rad] (n, 6).
        rms: of `error` over the run (6,).
        peak: largest magnitude of `error` (6,).
        rms_due: rms with the command due at that instant, one cycle older (6,).
    """

    label: str
    outcome: Outcome
    time: FloatArray
    error: FloatArray
    rms: FloatArray
    peak: FloatArray
    rms_due: FloatArray


def measure_release(plant: Plant, legs: Legs, duration: float, seed: int | None) -> ReleaseError:
    """Run `release_table_5_2` and take the positioning error from release on.

    The thesis takes commanded less actual position of the platform. Here: the pose in force at
    an instant, which the computer sent for the end of its cycle, less the true pose. `rms_due`
    takes the pose that was due at the instant instead, leaving out the cycle that is planned.
    """
    changes = {"legs": legs.model_dump(mode="json"), "run.duration": duration}
    run = simulate(Scenario.load("release_table_5_2", changes), plant, seed)
    command, truth = run["platform.command"], run["truth.pose"]
    error, due = command - truth, command[:-1] - truth[1:]
    return ReleaseError(
        label=f"{legs.gain:g} 1/s, filter {legs.filter.value}",
        outcome=Outcome(run.info.outcome),
        time=run.time,
        error=error,
        rms=np.sqrt(np.mean(error**2, axis=0)),
        peak=np.max(np.abs(error), axis=0),
        rms_due=np.sqrt(np.mean(due**2, axis=0)),
    )


def compare_releases(
    plant: Plant,
    settings: Sequence[Legs],
    duration: float,
    seed: int | None = None,
    progress: Callable[[float, str], None] = lambda share, what: None,
) -> list[ReleaseError]:
    """The releases of several leg settings, the first the one compared with."""
    found = []
    for done, legs in enumerate(settings):
        progress(done / len(settings), f"gain {legs.gain:g}, filter {legs.filter.value}")
        found.append(measure_release(plant, legs, duration, seed))
    progress(1.0, "done")
    return found


def reduction(before: FloatArray, after: FloatArray) -> FloatArray:
    """Share by which a figure fell, axis by axis (6,)."""
    return np.asarray(1.0 - after / before)


@final
class PositioningErrorTest(Procedure):
    """Releases at each leg setting; the first one is the case before the filter."""

    procedure: Literal["positioning_error"]
    duration: Annotated[Seconds, Field(gt=0, le=600)] = 10.0
    legs: Annotated[tuple[Legs, ...], Field(min_length=2)] = (
        Legs(gain=12.6),
        Legs(gain=20.9, filter=FilterPlace.ERROR),
        Legs(gain=20.9, filter=FilterPlace.FEEDBACK),
    )

    def carry_out(self, conduct: RunContext) -> Result:
        """Release, compare, draw."""
        plant = conduct.plant or Plant.load(self.plant)
        releases = compare_releases(plant, self.legs, self.duration, conduct.seed, conduct.progress)
        draw_releases(releases, conduct.folder / PICTURE)
        bad = [r.outcome for r in releases if r.outcome is not Outcome.COMPLETED]
        values: dict[str, JsonValue] = {
            "plant_hash": plant.hash,
            "axes": list(AXES),
            "releases": _values(releases),
        }
        return Result(bad[0] if bad else Outcome.COMPLETED, values, _lines(releases))


def _values(releases: Sequence[ReleaseError]) -> JsonValue:
    first = releases[0]
    return [
        {
            "legs": r.label,
            "outcome": r.outcome.value,
            "rms": r.rms.tolist(),
            "peak": r.peak.tolist(),
            "rms_due": r.rms_due.tolist(),
            "reduction": reduction(first.rms, r.rms).tolist(),
            "reduction_peak": reduction(first.peak, r.peak).tolist(),
            "reduction_due": reduction(first.rms_due, r.rms_due).tolist(),
            "mean_reduction": float(np.mean(reduction(first.rms, r.rms))),
        }
        for r in releases
    ]


def _lines(releases: Sequence[ReleaseError]) -> tuple[str, ...]:
    first = releases[0]
    names = [f"{axis} {unit}" for axis, unit in zip(AXES, _UNITS, strict=True)]
    lines = [f"  {'rms of command less true pose':<32}" + "".join(f"{n:>9}" for n in names)]
    for r in releases:
        lines.append(f"  {r.label:<32}" + "".join(f"{1e3 * x:9.2f}" for x in r.rms))
    for r in releases[1:]:
        cut = 100.0 * reduction(first.rms, r.rms)
        text = "".join(f"{x:9.0f}" for x in cut)
        lines.append(f"  {'less by %, ' + r.label:<32}{text}   mean {np.mean(cut):.0f}")
    return tuple(lines)


def draw_releases(releases: Sequence[ReleaseError], path: Path) -> Path:
    """Draw the error of every axis over time, one line a leg setting."""
    figure = new_figure(6.4, PICTURE_WIDTH)
    for i, axes in enumerate(figure.subplots(3, 2, sharex=True).T.ravel()):
        for n, r in enumerate(releases):
            axes.plot(r.time, 1e3 * r.error[:, i], lw=1.0, color=f"C{n}", label=r.label)
        axes.set_ylabel(f"{AXES[i]} [{_UNITS[i]}]", fontsize=8)
        axes.grid(alpha=0.3)
        if i in (2, 5):
            axes.set_xlabel("time since release [s]", fontsize=8)
        if i == 0:
            axes.legend(fontsize=7)
    figure.suptitle("commanded less true pose, release of Table 5-2", fontsize=10)
    return save_picture(figure, path)
