"""save_bare: write a recording that tells nothing but what a laboratory would know of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ves_twin.core.errors import FileAccessError
from ves_twin.core.recording.files import save_recording
from ves_twin.core.recording.recording import Recording, RecordingInfo


def save_bare(recording: Recording, path: Path) -> None:
    """Write it.

    Raises:
        FileAccessError: not writable.
    """
    info = RecordingInfo(
        "measured",
        scenario=recording.info.scenario,
        settings=recording.info.settings,
        log=recording.info.log,
        period=recording.info.period,
        own_signals=recording.info.own_signals,
    )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileAccessError(f"cannot write {path.parent}: {error.strerror}") from None
    save_recording(replace(recording, info=info), path)
