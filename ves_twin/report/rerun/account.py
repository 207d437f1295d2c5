"""account: a recording's question, origin, outcome and emulation error as a page of text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.report.rerun.rig import settings_of
from ves_twin.report.rerun.series import shown
from ves_twin.simulator.emulation_error import emulation_error
from ves_twin.simulator.outcome import Outcome

_NEEDED = ("truth.pose", "reference.pose", "reference.pose_leg_lag")


def account(recording: Recording, note: str = "") -> str:
    """Markdown page about a recording.

    Args:
        recording: what it is about.
        note: what differs between the drawn rig and the recorded one.
    """
    question = str(settings_of(recording.info).get("question") or "")
    parts = [question, _error_table(recording), *_facts(recording, note)]
    return "\n\n".join(part for part in parts if part) + "\n"


def _facts(recording: Recording, note: str) -> tuple[str, ...]:
    info = recording.info
    return (
        f"**{_outcome(info)}**",
        f"{info.scenario or 'no scenario'}, {info.origin}; plant {info.plant or 'unknown'}"
        f" (hash {info.plant_hash or 'unknown'}), seed {info.seed}; {len(recording)} rows on the"
        f" {info.log or 'unknown'} clock, {_period(info)}",
        note,
        ", ".join(f"{name} {version}" for name, version in info.versions.items()),
    )


def _outcome(info: RecordingInfo) -> str:
    try:
        return f"{info.outcome}: {Outcome(info.outcome).advice}"
    except ValueError:
        return info.outcome


def _period(info: RecordingInfo) -> str:
    return f"{1e3 * info.period:.6g} ms apart" if info.period else "period not given"


def _error_table(recording: Recording) -> str:
    if not len(recording) or not set(_NEEDED) <= set(recording.signals):
        return ""
    truth, ideal, lag = (recording[name] for name in _NEEDED)
    if not all(np.isfinite(values).all() for values in (truth, ideal, lag)):
        return "Emulation error: not given, the motion is not finite."
    pose = SIGNALS["truth.pose"]
    rows = []
    for (axis, error), unit in zip(
        emulation_error([(truth, ideal, lag)], _home(recording.info)).items(),
        pose.units,
        strict=True,
    ):
        factor, label = shown("truth.pose", unit)
        values = (error.rms, error.peak, error.rms_leg_lag, error.rms_rest)
        numbers = [f"{factor * value:.3g}" for value in values]
        relative = "-" if error.relative is None else f"{100 * error.relative:.2g} %"
        rows.append((f"{axis} [{label}]", *numbers, relative))
    head = ("axis", "rms", "peak", "rms, leg lag alone", "rms, the rest", "peak / motion")
    return "Emulation error: true pose less zero-g reference\n\n" + _table(head, rows)


def _home(info: RecordingInfo) -> FloatArray | None:
    """Pose from which motion counts (6,), where the recording's scenario tells it."""
    platform = settings_of(info).get("platform")
    try:
        home = np.array(platform.get("home") if isinstance(platform, dict) else None, float)
    except (TypeError, ValueError):
        return None
    return home if home.shape == (6,) and np.all(np.isfinite(home)) else None


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
