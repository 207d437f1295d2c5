"""check_weight: whether the force sensor carries a plausible payload in its own axes."""

from __future__ import annotations

import numpy as np

from ves_twin.core.recording.recording import Recording
from ves_twin.data.quality.check import Check, failed, passed, unknown

SHARE = 0.3
"""By how much of the weight the mean force may miss it."""


def check_weight(recording: Recording, weight: float) -> list[Check]:
    """Whether the mean force is the payload's weight along +z of the sensor.

    Level on average, the payload pulls along +z of the sensor's axes. Another axis means frames
    that are swapped; another sign, a sensor that reports what it exerts; another size, units.

    Args:
        recording: with `sensor.wrench`; tared recordings cannot tell.
        weight: of the payload [N].
    """
    name = "sensor.wrench"
    if name not in recording.signals:
        return [unknown("frame", "no sensor.wrench")]
    force = np.nanmean(recording[name][:, :3], axis=0)
    size, axis = float(np.linalg.norm(force)), int(np.argmax(np.abs(force)))
    if size < SHARE * weight:
        return [unknown("frame", f"mean force {size:.3g} N: the sensor looks tared", name)]
    if axis != 2:
        text = f"the weight lies along axis {'xyz'[axis]}, expected z: axes look swapped"
        return [failed("frame", text, name)]
    if force[2] < 0.0:
        text = "mean Fz is negative, expected the weight as +Fz: the sign looks turned"
        return [failed("frame", text, name)]
    if abs(size / weight - 1.0) > SHARE:
        text = f"mean force {size:.4g} N, expected about {weight:.4g} N: units or payload?"
        return [failed("units", text, name)]
    return [passed("frame", f"mean force {size:.1f} N along +z", name)]
