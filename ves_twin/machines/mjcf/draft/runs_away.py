"""runs_away: whether a simulation leaves a log whole, so that pieces of it tell more."""

from __future__ import annotations

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.mjcf.motion.forward import MjcfForward

NUDGE = 1e-3
"""Of the sd of a start: small enough that what comes of it is a straight line's worth."""

GROWTH = 20.0
"""Factor from the first quarter of a log to that in which it is largest: a nudge of a speed that
nothing brakes grows by 7, that of a table on its point (tau of 1.1 s, 9 s) by 36."""

SPOILT = 0.5
"""Share of a channel's spread by which an unknown start then puts it off."""

LOUD = 10.0
"""Times the noise of a row that a channel must swing for its swings to be compared."""


def runs_away(forward: MjcfForward, recording: Recording) -> bool:
    """Whether a log has to be predicted in pieces.

    What is not known of a start grows until it hides what the log tells: a table on its point, or a
    pendulum held upright, whose whole log no model predicts. Or the simulation is out of step: what
    it leaves of the swings of a channel, about a slow trend, is more than these. A search among
    whole logs then ends in a wrong valley (a satellite's mass centre, 37 mm for 2). A drift, and a
    wrong size in step, are no reason.

    Args:
        forward: of the drafted machine.
        recording: of a log.
    """
    fed = Excitation.of(recording, forward.drive)
    starts = [p for p in forward.parameters if p.per_recording and p.sd > 0.0]
    nudged = {p.name: p.nominal + NUDGE * p.sd for p in starts}
    told = forward.simulate(fed, {})
    off = (forward.simulate(fed, nudged) - told) / NUDGE
    first, *rest = (_rms(part) for part in np.array_split(off, 4))
    most = np.max(rest, axis=0)
    measured = np.stack([recording[c.signal][:, c.column] for c in forward.channels], axis=1)
    grown = ~(most <= np.maximum(SPOILT * np.std(measured, axis=0), GROWTH * first))
    swings, left = _rms(_detrended(measured)), _rms(_detrended(measured - told))
    noise = np.array([channel.sd for channel in forward.channels])
    return bool(np.any(grown | (~(left <= swings) & (swings > LOUD * noise))))


def _detrended(rows: FloatArray) -> FloatArray:
    """Rows (n, c) less a parabola in time each."""
    shapes = np.vander(np.linspace(-1.0, 1.0, len(rows)), 3)
    return np.asarray(rows - shapes @ np.linalg.lstsq(shapes, np.nan_to_num(rows), rcond=None)[0])


def _rms(rows: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(np.square(rows), axis=0)))
