"""account: a recording's question, origin, outcome and emulation error as a page of text."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ves_twin.recording.recording import Recording, RecordingInfo
from ves_twin.rerun_log.rig import settings_of
from ves_twin.rerun_log.series import shown
from ves_twin.signals import SIGNALS
from ves_twin.simulator.emulation_error import emulation_error
from ves_twin.simulator.outcome import Outcome

_NEEDED = ("truth.pose", "reference.pose", "reference.pose_leg_lag")


def account(recording: Recording, note: str = "") -> str:
    """Markdown page about a recording.

    Args:
        recording: what it is about.
        note: what differs between the drawn rig and the recorded one.
    """
    info = recording.info
    parts = [f"## {info.scenario or 'Recording'}"]
    question = settings_of(info).get("question")
    if question:
        parts.append(str(question))
    parts += [_facts(recording, note), _error_table(recording), _versions(info)]
    return "\n\n".join(part for part in parts if part) + "\n"


def _facts(recording: Recording, note: str) -> str:
    info = recording.info
    lines = [
        f"**{_outcome(info)}**",
        f"{info.origin}, plant {info.plant or 'unknown'} (hash {info.plant_hash or 'unknown'}),"
        f" seed {info.seed}, {len(recording)} rows on the {info.log or 'unknown'} clock,"
        f" {_period(info)}",
    ]
    if note:
        lines.append(f"Drawing: {note}")
    return "\n\n".join(lines)


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
        emulation_error(truth, ideal, lag).items(), pose.units, strict=True
    ):
        factor, label = shown("truth.pose", unit)
        values = (error.rms, error.peak, error.rms_leg_lag, error.rms_rest)
        numbers = [f"{factor * value:.3g}" for value in values]
        rows.append((f"{axis} [{label}]", *numbers, f"{100 * error.relative:.2g} %"))
    head = ("axis", "rms", "peak", "rms, leg lag alone", "rms, the rest", "peak / motion")
    return "Emulation error: true pose less zero-g reference\n\n" + _table(head, rows)


def _versions(info: RecordingInfo) -> str:
    if not info.versions:
        return ""
    return "Versions: " + ", ".join(f"{name} {v}" for name, v in info.versions.items())


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
