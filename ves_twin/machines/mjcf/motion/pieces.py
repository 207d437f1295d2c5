"""pieces: a recording cut where simulation begins anew from what was measured."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.diagnosis.record.preprocess import fewest_rows
from ves_twin.machines.mjcf.motion.started import lead_rows
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import SINGLE

MEASURED = "measured"
"""Start of a joint that any row can tell."""

LONGEST = 4.0 / 3.0
"""Of a horizon that a piece may be."""


def pieces(rig: Rig, recording: Recording) -> tuple[Recording, ...]:
    """The recording in equal pieces of about `drive.horizon`, each with its lead before it.

    A simulation runs away from what was measured: an error of the speed e^(t/T) of an unstable
    joint, t of a free one. Over a horizon it stays where what is wrong acts in a straight line.

    Args:
        rig: the two files.
        recording: of one motion.

    Returns:
        The pieces in order, two thirds to four thirds of a horizon long, or up to two horizons
        where they would else have too few rows; the recording alone where the machine has no
        horizon or the recording is not longer.

    Raises:
        InvalidInputError: a joint whose start no row tells.

    Source: Bock 1983, Recent advances in parameter identification techniques for ODE (multiple
    shooting; here the pieces are not tied to each other).
    """
    drive, time = rig.description.drive, recording.time
    if not drive.horizon or drive.mode is Mode.MOTION or recording.info.log == POSES:
        return (recording,)
    _check_starts(rig)
    lead = lead_rows(rig, time)
    step = (float(time[-1]) - float(time[0])) / (len(time) - 1)
    count = _count(len(time) - lead, step, rig)
    if count < 2:
        return (recording,)
    ends = np.linspace(lead, len(time), count + 1).round().astype(int)
    found = []
    for begin, end in pairwise(ends):
        rows = slice(begin - lead, end)
        signals = {name: values[rows] for name, values in recording.signals.items()}
        found.append(replace(recording, time=time[rows], signals=signals))
    return tuple(found)


def _count(rows: int, step: float, rig: Rig) -> int:
    """Of pieces about a horizon long; longer by a third where it takes that for enough rows.

    Of a horizon that has enough rows all pieces have, be it with one piece fewer.
    """
    horizon = rig.description.drive.horizon
    fewest = fewest_rows(step, rig.description.rate)
    count, most = round(rows * step / horizon), rows // fewest
    long = horizon >= (fewest - 1) * step or rows * step <= most * LONGEST * horizon
    return min(count, most) if most and long else count


def _check_starts(rig: Rig) -> None:
    """Raise InvalidInputError where a piece would not know how a joint begins."""
    drive, starts = rig.description.drive, rig.description.start
    still = {*drive.imposed, *drive.locked}
    for i in range(rig.model.njnt):
        joint = rig.model.joint(i)
        told = starts.get(joint.name)
        if joint.name in still or (told is not None and told.position == MEASURED):
            continue
        came = f"a horizon, and joint {joint.name or i}, of which no row tells the start"
        expected = f'start.{joint.name} = {{ position = "measured", ... }}, or no drive.horizon'
        if int(joint.type[0]) not in SINGLE:
            expected = "joints that turn or slide, or no drive.horizon"
        raise InvalidInputError("drive.horizon", came, expected)
