"""rig_recording: a recording of ours, imported or simulated, as one of a rig: signals by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.even_clock import even_clock
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.types import FloatArray
from ves_twin.core.units import to_unit
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.parts.turned import turned
from ves_twin.machines.mjcf.rig.machine import Rig


def rig_recording(recording: Recording, rig: Rig, name: str) -> Recording:
    """The signals of a rig out of a recording that has them by name.

    Numbers are converted to the units of the rig's file, `into` turns vectors; the columns, scales
    and offsets of the file are of raw logs and not used. Rows go onto an even clock, with NaN where
    nothing was measured.

    Args:
        recording: for instance of `import_log`.
        rig: whose signals are taken; those that are compared may be missing.
        name: what the recording is called.

    Raises:
        UnknownNameError: a signal that is fed in and not there; says the nearest one.
        InvalidInputError: another width or a unit of another dimension.
    """
    told = rig.description
    drive = MjcfForward.of(rig).drive
    for signal in drive:
        if signal not in recording.signals:
            raise UnknownNameError(f"signal in {name}", signal, recording.signals)
    signals = {n: _converted(recording, n, rig) for n in told.signals if n in recording.signals}
    for n in list(signals):
        if told.signals[n].into:
            signals[n] = turned(signals[n], signals, n, told.signals[n].into)
    poses = told.clock.poses
    info = replace(recording.info, scenario=name, log=POSES if poses else "")
    found = Recording(recording.time, signals, info)
    return found if poses else even_clock(found, drive)


def _converted(recording: Recording, name: str, rig: Rig) -> FloatArray:
    column, values = rig.description.signals[name], recording[name]
    width = len(column.columns)
    if values.shape[1] != width:
        raise InvalidInputError(f"columns of {name}", values.shape[1], f"{width} as in the rig")
    rows = []
    for i, given in enumerate(recording.info.signal(name).units):
        factor, offset = to_unit(given, column.unit, name)
        same = factor == 1.0 and offset == 0.0
        rows.append(values[:, i] if same else factor * values[:, i] + offset)
    return np.stack(rows, axis=1)
