"""read_recording: a recording of a rig from whatever it lies in: raw log, log and map, import."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ves_twin.core.recording.files import is_recording, load_recording, recording_name
from ves_twin.core.recording.recording import Recording
from ves_twin.data.formats.open_log import open_log
from ves_twin.data.import_log import import_log
from ves_twin.data.mapping.import_map import ImportMap
from ves_twin.machines.mjcf.recordings.columns import read_rig_recording
from ves_twin.machines.mjcf.recordings.recorded import rig_recording
from ves_twin.machines.mjcf.recordings.signals import rig_ranges, rig_signals
from ves_twin.machines.mjcf.rig.machine import Rig


def read_recording(path: Path, rig: Rig, told: ImportMap | None = None) -> Recording:
    """A recording of a rig.

    A file that `ves-twin import` wrote has its signals by name. Any other is read by the columns
    that the rig's file names, or as a map says.

    Args:
        path: the file, or the folder of a run.
        rig: whose signals are read.
        told: which column of a lab file is which signal; None: the rig's file says it.

    Raises:
        VesTwinError: a file that is missing, or does not hold what the rig or the map names.
    """
    name = Path(recording_name(path)).stem
    if is_recording(path):
        return rig_recording(load_recording(path), rig, name)
    if told is None:
        raw = read_rig_recording(path, rig)
        return replace(
            raw, info=replace(raw.info, imported={**raw.info.imported, "file": path.name})
        )
    known, plausible = rig_signals(rig), rig_ranges(rig)
    log = import_log(open_log(path), told, plausible=plausible, known=known)
    return rig_recording(log.recording, rig, name)
