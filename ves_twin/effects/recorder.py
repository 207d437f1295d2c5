"""Effects of VES II's recorder: what stands in the log alone, which no controller reads.

On machines of an MJCF model a reading is what the log holds anyway: `sensor_offset`, `sensor_gain`,
`sensor_delay` and `cross_talk` are that there. So they are on the wrench of VES II, which no leg
or joint is controlled by; what zeroing leaves of it is an error of every recording.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from ves_twin.core.types import FloatArray
from ves_twin.effects.added import added
from ves_twin.effects.change import Log
from ves_twin.effects.effect import Effect
from ves_twin.effects.magnitude import Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import Part, Row
from ves_twin.effects.shifted import shifted
from ves_twin.effects.size import LENGTH, Size

LENGTHS, ANGLES, TORQUES = Log("leg.length"), Log("arm.q"), Log("arm.torque")


def _columns(log: Log, count: int) -> tuple[str, ...]:
    return tuple(f"{log.signal}.{i + 1}" for i in range(count))


def _scanned(log: Log, count: int) -> tuple[str, ...]:
    """Each column but the first, reading the one that a multiplexer scans before it."""
    return tuple(f"{log.signal}.{i + 1}.{i}" for i in range(1, count))


@final
@dataclass(frozen=True)
class RecorderOffset(Effect):
    """A column of the log is off by a constant: x -> x + offset.

    Of the arm's torques it would be `force_offset`, to the log.
    """

    offset: float = 0.0

    kind = "recorder_offset"
    sizes = (Size("offset", LENGTH),)
    source = "assumed; zero of a converter that the recorder has for itself"
    rows = (
        Row(_columns(LENGTHS, 6), (0.0, 3e-4, 0.02), ("leg.length",), LENGTHS, Part.TRANSDUCER),
        Row(_columns(ANGLES, 3), (0.0, 1e-3, 0.05), ("arm.q",), ANGLES, Part.ARM),
    )

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add the offset."""
        return added(reading, self.column, self.offset)


@final
@dataclass(frozen=True)
class RecorderGain(Effect):
    """A column of the log is scaled: x -> (1 + gain) x.

    Of the arm's torques it would be `actuator_gain`, to the log.
    """

    gain: float = 0.0

    kind = "recorder_gain"
    sizes = (Size("gain", "1"),)
    source = "assumed; span of a converter that the recorder has for itself"
    rows = (
        Row(_columns(LENGTHS, 6), (0.0, 5e-4, 0.02), ("leg.length",), LENGTHS, Part.TRANSDUCER),
        Row(_columns(ANGLES, 3), (0.0, 1e-3, 0.1), ("arm.q",), ANGLES, Part.ARM),
    )

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add its share of the true value."""
        return added(reading, self.column, self.gain * true[:, self.column])


@final
@dataclass(frozen=True)
class RecorderDelay(Effect):
    """A length, or all angles or torques, stand late in the log: x(t) -> x(t - delay)."""

    delay: float = 0.0

    kind = "recorder_delay"
    sizes = (Size("delay", "s", Sign.POSITIVE),)
    source = "assumed; a channel buffered for some rows, or read by another task"
    proportional = False
    rows = (
        Row(_columns(LENGTHS, 6), (0.0, 5e-4, 0.05), ("leg.length",), LENGTHS, Part.TRANSDUCER),
        Row((ANGLES.signal,), (0.0, 5e-4, 0.05), ("arm.q",), ANGLES, Part.ARM),
        Row((TORQUES.signal,), (0.0, 5e-4, 0.05), ("arm.torque",), TORQUES, Part.ARM),
    )

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """What was read a delay ago."""
        late = shifted(reading, time, self.delay)
        if not self.target[-1].isdigit():
            return late
        return added(reading, self.column, (late - reading)[:, self.column])


@final
@dataclass(frozen=True)
class RecorderCrossTalk(Effect):
    """A column of the log holds a share of the one scanned before it: x_i -> x_i + share x_j.

    Target "arm.q.3.2" is q3 holding a share of q2.
    """

    share: float = 0.0

    kind = "recorder_cross_talk"
    sizes = (Size("share", "1"),)
    source = "assumed; charge that a multiplexer carries on to the next channel"
    rows = (
        Row(_scanned(LENGTHS, 6), (0.0, 5e-4, 0.02), ("leg.length",), LENGTHS, Part.TRANSDUCER),
        Row(_scanned(ANGLES, 3), (0.0, 1e-3, 0.1), ("arm.q",), ANGLES, Part.ARM),
        Row(_scanned(TORQUES, 3), (0.0, 2e-3, 0.1), ("arm.torque",), TORQUES, Part.ARM),
    )

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add a share of the other column."""
        to, of = (int(number) - 1 for number in self.target.split(".")[-2:])
        return added(reading, to, self.share * true[:, of])
