"""implausible: what a machine's file cannot be right about, by recordings and before any fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import BoolArray, FloatArray
from ves_twin.machines.mjcf.plausible.load_fits import load_fits
from ves_twin.machines.mjcf.plausible.reading import Reading
from ves_twin.machines.mjcf.plausible.seen import Seen
from ves_twin.machines.mjcf.rig.machine import Rig

BAD = 0.5
"""Share of an effort's spread that the model, and friction that resists, may leave: a published
arm without its frictions leaves 0.2 (TX40), a wrong sign two."""

GOOD = 0.35
"""Share from which another reading of the columns is right: by chance none comes as near."""

FEWER = 0.5
"""Times the share before, that another reading must leave at most."""

LOUD, MUCH = 0.2, 0.25
"""Share of an effort's spread from which, and times that share down to which, another reading is
right as well: an angle from the world spoils an effort less than a sign. Chosen on an arm of three
joints (a test), whose elbow read so leaves 0.48, and 0.07 read right."""

GROWS = 1.1
"""Times the share before, that it may leave of any other effort."""

ALIKE = 1.1
"""Times the least share, within which two readings are told together: a torque or the angle of its
joint turned is often the same."""


@dataclass(frozen=True)
class Implausible:
    """What the columns of a machine look like instead.

    Attributes:
        what: the signals in question.
        came: what the recording shows.
        expected: which key of the machine's file to look at.
    """

    what: str
    came: str
    expected: str

    @property
    def error(self) -> InvalidInputError:
        """As a refusal."""
        return InvalidInputError(self.what, self.came, self.expected)


def implausible(rig: Rig, recording: Recording) -> Implausible | None:
    """What of a recording fits the machine only if it is read in another way.

    Where the position of every joint and the effort of an actuator were recorded, the effort must
    be that of inverse dynamics, an offset, and friction that takes energy out:

        u = u_rigid(q) + c v + f sign(v) + o,  c >= 0, f >= 0.

    That holds in every mode, since it is no simulation in time. Where it leaves most of an effort,
    signs, units and order of columns and the sign of gravity are turned round one by one; a
    reading that leaves a small part of it is named, at last by a factor of more than twenty that no
    usual unit has. Causes change an effort by a part of it. What
    leaves less, down to LOUD, may be an angle from the world alone. Where a load on the last body
    of an arm leaves as little, columns are not in question.

    Args:
        rig: the machine.
        recording: of it.

    Returns:
        None where nothing can be said, or all is well.
    """
    seen = Seen.of(rig, recording)
    if seen is None:
        return None
    plain = seen.left(Reading("", "", {}, {}))
    if np.all(plain <= LOUD):
        return None
    found, ways = list[tuple[float, FloatArray, BoolArray, Reading]](), seen.readings
    every = chain(ways.every(), seen.in_another_unit())
    for reading in every if np.any(plain > BAD) else ways.from_the_world():
        if found and reading.odd:
            break
        left = seen.left(reading)
        changed = (plain > BAD) & (left < np.minimum(FEWER * plain, GOOD))
        changed |= bool(reading.less) & (plain > LOUD) & (left < MUCH * plain)
        if np.any(changed) and np.all(left <= GROWS * np.maximum(plain, GOOD)):
            found.append((float(np.sum(np.minimum(left, 1.0))), left, changed, reading))
    if not found:
        return None
    least, left, *_ = min(found, key=lambda one: one[0])
    if load_fits(seen, left, GOOD):
        return None
    best = [(changed, reading) for score, _, changed, reading in found if score <= ALIKE * least]
    names = [seen.names[i] for i in np.flatnonzero(best[0][0])]
    came = " or ".join(dict.fromkeys(reading.name for _, reading in best))
    keys = " or ".join(dict.fromkeys(reading.key for _, reading in best))
    what = f"{', '.join(names)} of {recording.info.scenario or 'the recording'}"
    if any(reading.in_unit for _, reading in best):
        keys += ", and the masses of the model"
    return Implausible(what, f"efforts that fit the model only with {came}", f"check {keys}")


def check_plausible(rig: Rig, recordings: Sequence[Recording]) -> None:
    """Refuse the first recording that fits the machine only if it is read in another way.

    Raises:
        InvalidInputError: says which columns, and which key of the file to look at.
    """
    for recording in recordings:
        found = implausible(rig, recording)
        if found is not None:
            raise found.error
