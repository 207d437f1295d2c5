"""runs_away: whether a simulation leaves a log for no other reason than where it began."""

from __future__ import annotations

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.forward import Excitation
from ves_twin.machines.mjcf.forward import MjcfForward

NUDGE = 1e-3
"""Of the sd of a start: small enough that what comes of it is a straight line's worth."""

GROWTH = 20.0
"""Factor from the first quarter of a log to that in which it is largest: a nudge of a speed that
nothing brakes grows by 7, that of a table on its point (tau of 1.1 s, 9 s) by 36."""

SPOILT = 0.5
"""Share of a channel's spread by which an unknown start then puts it off."""


def runs_away(forward: MjcfForward, recording: Recording) -> bool:
    """Whether what is not known of a start grows until it hides what a log tells.

    A table on its point, or a pendulum held upright: no whole log of it can be predicted, however
    right the model. One that only has a wrong number can, once that number is fitted.

    Args:
        forward: of the drafted machine.
        recording: of a log.
    """
    fed = Excitation.of(recording, forward.drive)
    starts = [p for p in forward.parameters if p.per_recording and p.sd > 0.0]
    nudged = {p.name: p.nominal + NUDGE * p.sd for p in starts}
    off = (forward.simulate(fed, nudged) - forward.simulate(fed, {})) / NUDGE
    first, *rest = (_rms(part) for part in np.array_split(off, 4))
    most = np.max(rest, axis=0)
    spread = np.array([np.std(recording[c.signal][:, c.column]) for c in forward.channels])
    return bool(np.any(~(most <= np.maximum(SPOILT * spread, GROWTH * first))))


def _rms(rows: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(np.square(rows), axis=0)))
