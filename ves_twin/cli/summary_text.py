"""summary_text: the account of a run as a person reads it."""

from __future__ import annotations

from pathlib import Path

from ves_twin.simulator.emulation_error import AxisError
from ves_twin.simulator.simulate import SUMMARY_NAME, Summary
from ves_twin.simulator.tracking_error import TrackingError

_MILLI = 1e3


def summary_text(summary: Summary, folder: Path) -> str:
    """Question, outcome, speed, error per axis, events, and where the files lie."""
    lines = [
        f"{summary.scenario}: {summary.question}",
        f"  outcome   {summary.outcome.value} at {summary.duration:.2f} s ({summary.advice})",
        f"  plant     {summary.plant} {summary.plant_hash}, seed {summary.seed}",
        f"  speed     {summary.timing.real_time_factor:.1f} x real time,"
        f" admittance loop at {summary.timing.admittance_rate:.2f} Hz",
    ]
    if summary.emulation_error:
        lines += ["", *_error_table(summary.emulation_error)]
    if summary.tracking_error:
        lines += ["", *_tracking_table(summary.tracking_error)]
    warnings = [e for e in summary.events if e["kind"] not in {"settled", "zeroed"}]
    lines += ["", *(f"  {e['time']:8.3f} s  {e['kind']}: {e['message']}" for e in warnings)]
    files = [name for name in sorted(p.name for p in folder.iterdir()) if _ours(name)]
    lines += ["", f"  files     {folder}/", *(f"              {name}" for name in files)]
    if "run.rrd" in files:
        lines += [f"  look      ves-twin view {folder}"]
    return "\n".join(lines)


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.1%}"


def _ours(name: str) -> bool:
    return name == SUMMARY_NAME or name.endswith((".parquet", ".rrd", ".arrows"))


def _error_table(errors: dict[str, AxisError]) -> list[str]:
    rows = [
        "  emulation error against the zero-g reference",
        "  axis       rms      peak  of the motion   legs alone   the rest",
    ]
    for axis, error in errors.items():
        unit = "mrad" if axis.startswith("r") else "mm"
        rms, peak, legs, rest = (
            _MILLI * value for value in (error.rms, error.peak, error.rms_leg_lag, error.rms_rest)
        )
        share = _share(error.relative)
        rows.append(
            f"  {axis:<3}{unit:>5}{rms:8.3f}{peak:10.3f}{share:>14}{legs:13.3f}{rest:11.3f}"
        )
    rows.append(
        "  (legs alone = rms error from the legs' lag only; the rest = rms of everything else)"
    )
    if any((error.relative or 0.0) > 1.0 for error in errors.values()):
        rows.append(
            "  (above 100 %: the base went further by its error than it should move. A base that no"
            " spring holds drifts so: sensor noise pushes it, the longer the further)"
        )
    return rows


def _tracking_table(errors: dict[str, TrackingError]) -> list[str]:
    rows = [
        "  tracking error: true pose less commanded pose",
        "  axis       rms      peak  of the motion",
    ]
    for axis, error in errors.items():
        unit = "mrad" if axis.startswith("r") else "mm"
        rms, peak = _MILLI * error.rms, _MILLI * error.peak
        rows.append(f"  {axis:<3}{unit:>5}{rms:8.3f}{peak:10.3f}{_share(error.relative):>14}")
    return rows
