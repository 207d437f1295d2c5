"""rig_signals, rig_ranges, with_signals: what a rig records, for imports and quality checks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.signals import Role, Signal
from ves_twin.core.types import FloatArray
from ves_twin.machines.mjcf.rig.column import Column
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import typical_span

WIDE = 10.0
"""Times the typical size that a signal may be before another unit is suspected: typical sizes are
rough, and mm for m are off by 1000."""


def rig_signals(rig: Rig) -> tuple[Signal, ...]:
    """The signals of a rig's file; those that hold from row to row are commands."""
    told = rig.description
    commands = {*told.drive.actuators.values(), *(c.reference for c in told.controllers.values())}
    return tuple(
        _signal(name, column, Role.COMMAND if name in commands else Role.MEASUREMENT)
        for name, column in told.signals.items()
    )


def with_signals(recording: Recording, rig: Rig) -> Recording:
    """The recording with what the rig's file says of its signals: units, and which are commands."""
    own = tuple(one for one in rig_signals(rig) if one.name in recording.signals)
    return replace(recording, info=replace(recording.info, own_signals=own))


def _signal(name: str, column: Column, role: Role) -> Signal:
    width = len(column.columns)
    axes = tuple(f"{i + 1}" for i in range(width))
    return Signal(name, axes, (column.unit,) * width, role, column.into, column.source)


def rig_ranges(rig: Rig) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Range about zero that each signal with a typical size can have, WIDE of it either way."""
    found = {}
    for name, column in rig.description.signals.items():
        size = typical_span(name, rig.description)
        if size > 0.0:
            reach = np.full(len(column.columns), WIDE * size)
            found[name] = (-reach, reach)
    return found
