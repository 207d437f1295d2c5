"""write_report: the account of a gravity calibration as tables, a picture and numbers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import JsonValue

from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import write_whole
from ves_twin.mechanics.gravity.identify import Identification
from ves_twin.mechanics.gravity.interleaved_split import Pass
from ves_twin.mechanics.gravity.poses import Conditioning
from ves_twin.mechanics.gravity.sensitivity import AXES
from ves_twin.procedures.procedure import Result
from ves_twin.report.picture import save_picture
from ves_twin.simulator.outcome import Outcome


@dataclass(frozen=True)
class Calibrated:
    """What a calibration found.

    Attributes:
        passes: the alternation, one pass more than asked for.
        found: the fit of all at once.
        pin: what fixed the hidden directions.
        truth: M_total and P of the simulated world, which no laboratory has (1 + p,).
        conditioning: of the poses.
    """

    passes: tuple[Pass, ...]
    found: Identification
    pin: str
    truth: FloatArray
    conditioning: Conditioning

    @property
    def last_change(self) -> float:
        """Relative change of the rms force or moment, the larger, by the pass after those asked."""
        before, after = (
            np.array([np.linalg.norm(p.rms[:3]), np.linalg.norm(p.rms[3:])])
            for p in self.passes[-2:]
        )
        return float(np.max(np.abs(after - before) / before))


def result_of(result: Calibrated) -> Result:
    """Numbers for the summary and lines for a person."""
    found = result.found
    half = found.half_width()[42:]
    rows: list[JsonValue] = [
        {
            "name": name,
            "value": float(value),
            "half_width_90": float(width) if np.isfinite(width) else None,
            "truth": float(true),
        }
        for name, value, width, true in zip(
            found.names[42:], found.values[42:], half, result.truth, strict=True
        )
    ]
    values: dict[str, JsonValue] = {
        "parameters": rows,
        "noise": found.noise.tolist(),
        "passes_rms": [p.rms.tolist() for p in result.passes],
        "last_pass_changes_rms_by": result.last_change,
        "hidden_from_gravity_poses": list(found.hidden),
        "pinned_by": result.pin,
        "condition_of_G": result.conditioning.condition,
    }
    return Result(Outcome.COMPLETED, values, tuple(_lines(result)))


def write_report(result: Calibrated, folder: Path, question: str) -> None:
    """Write `report.md` and `residuals.png` into a folder."""
    text = [f"# {question}", "", "```", *_lines(result), "```", "", "![](residuals.png)", ""]
    text += ["## Calibration matrix C (wrench per signal), rows as sensor axes", "", "```"]
    text += [" ".join(f"{v:10.5f}" for v in row) for row in result.found.calibration]
    text += ["```", "", "## Sensor: share of full scale, and half of its 90 % interval", "", "```"]
    half = result.found.half_width()
    for name, value, width in zip(result.found.names[:42], result.found.values, half, strict=False):
        text.append(f"{name:<16}{value:10.5f}   +- {width:.5f}")
    text += ["```", ""]
    write_whole(folder / "report.md", "\n".join(text))
    _picture(result, folder / "residuals.png")


def _lines(result: Calibrated) -> list[str]:
    found = result.found
    half = found.half_width()[42:]
    lines = [f"  {'':<11}{'identified':>11}{'90 % within':>13}{'truth':>10}   [kg, kg m]"]
    for row in zip(found.names[42:], found.values[42:], half, result.truth, strict=True):
        name, value, width, true = row
        shown = f"+- {width:.3f}" if np.isfinite(width) else "hidden"
        lines.append(f"  {name:<11}{value:11.3f}{shown:>13}{true:10.3f}")
    lines += ["", "  rms over the poses  " + "".join(f"{axis:>9}" for axis in AXES)]
    for number, one in enumerate(result.passes, 1):
        lines.append(f"  alternation {number:<8}" + "".join(f"{v:9.3f}" for v in one.rms))
    rms = np.sqrt(np.mean(found.residual**2, axis=0))
    lines.append("  all at once         " + "".join(f"{v:9.3f}" for v in rms))
    lines.append(
        f"  pass {len(result.passes)} changes rms force and moment by {result.last_change:.1%}"
    )
    shape = result.conditioning
    lines.append(
        f"  poses: cond(G) {shape.condition:.1f}, log det {shape.log_determinant:.1f}, smallest"
        f" eigenvalue {shape.smallest:.2f}"
    )
    lines += ["", *_hidden(result)]
    return lines


def _hidden(result: Calibrated) -> list[str]:
    if not result.found.hidden:
        return ["  hidden from these poses: nothing; the known weight shows it"]
    lines = ["  hidden from poses under gravity alone:"]
    lines += [f"    {name}" for name in result.found.hidden]
    advice = {
        "gain_prior": "  pinned by the prior on the gain (gain_sd); a known weight does without",
        "none": "  not pinned: no interval for what they touch (pin = gain_prior or weight)",
    }
    return [*lines, advice[result.pin]]


def _picture(result: Calibrated, path: Path) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to import
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    numbers = np.arange(1, len(result.found.residual) + 1)
    for axes, first, unit in zip(figure.subplots(1, 2), (0, 3), ("N", "N m"), strict=True):
        for i in range(first, first + 3):
            axes.plot(numbers, result.found.residual[:, i], "o-", ms=3, lw=0.7, label=AXES[i])
        axes.set_xlabel("pose")
        axes.set_ylabel(f"signal less model [{unit}]")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    save_picture(figure, path, 120)
