"""Effects of a sensor: gain, cross-talk, offset, drift, delay, mounting, low-pass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np
from numpy.polynomial.legendre import legvander

from ves_twin.core.types import FloatArray
from ves_twin.effects.added import added
from ves_twin.effects.change import Law, Loop, Table
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.magnitude import Magnitude, Sign
from ves_twin.effects.place import Place
from ves_twin.effects.row import AXES, JOINTS, Anywhere, Part, Row
from ves_twin.effects.shifted import shifted
from ves_twin.effects.size import Size

if TYPE_CHECKING:
    import mujoco

WRENCH = ("sensor.wrench",)


@final
@dataclass(frozen=True)
class SensorGain(Effect):
    """One column reads (1 + gain) times what is there, on VES II after cross-talk."""

    gain: float = 0.0

    kind = "sensor_gain"
    sizes = (Size("gain", "1"),)
    source = "thesis 3.2.4 (electronics gain); size as catalogues of such sensors"
    rows = (Row(AXES, (0.001, 0.003, 0.2), WRENCH, Loop("sensor.gain", Law.SCALE), Part.SENSOR),)
    anywhere = Anywhere(Element.SIGNAL, 0.3, 0.001, linear=True)

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add its share of the true value."""
        return added(reading, self.column, self.gain * true[:, self.column])

    def undo_reading(self, reading: FloatArray, time: FloatArray, place: Place) -> FloatArray:
        """Less its share."""
        share = self.gain / (1.0 + self.gain)
        return added(reading, self.column, -share * reading[:, self.column])


@final
@dataclass(frozen=True)
class CrossTalk(Effect):
    """One column reads a share of another's load: W_i -> W_i + share (r_i / r_j) W_j.

    On VES II r is the range of an axis, so that a share of 0.01 is one per cent of full scale
    whatever the units; target "sensor.mx.fz" is the moment about x reading the force along z. On
    other machines the columns of a signal have one unit and r_i = r_j; target "wrist.force.3.1" is
    column 3 reading 1.
    """

    share: float = 0.0

    kind = "cross_talk"
    sizes = (Size("share", "1"),)
    source = "thesis 3.2.4 (repeatable, linear, removed by a calibration matrix)"
    rows = (
        Row(
            tuple(f"{to}.{of.removeprefix('sensor.')}" for to in AXES for of in AXES if to != of),
            (0.0005, 0.002, 0.1),
            WRENCH,
            part=Part.SENSOR,
        ),
    )
    anywhere = Anywhere(Element.SIGNAL, 0.2, 0.001, columns=2, linear=True)

    def edit_loop(self, parameters: np.void) -> None:
        """Add an entry off the diagonal of the signal matrix."""
        _, to, of = self.target.split(".")
        i, j = AXES.index(f"sensor.{to}"), AXES.index(f"sensor.{of}")
        sensor = parameters["sensor"]
        sensor["gain"][i, j] += self.share * sensor["range"][i] / sensor["range"][j]

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add a share of the other column."""
        to, of = (int(number) - 1 for number in self.target.split(".")[-2:])
        return added(reading, to, self.share * true[:, of])


@final
@dataclass(frozen=True)
class SensorOffset(Effect):
    """One column reads off by a constant."""

    offset: float = 0.0

    kind = "sensor_offset"
    sizes = (Size("offset", ""),)
    anywhere = Anywhere(Element.SIGNAL, lambda p: 3.0 * p.span, linear=True)

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add the offset."""
        return added(reading, self.column, self.offset)


@final
@dataclass(frozen=True)
class EncoderOffset(Effect):
    """An encoder was zeroed off the joint's zero: it reads, and the servo holds, q + offset."""

    offset: float = 0.0

    kind = "encoder_offset"
    sizes = (Size("offset", "rad"),)
    source = "Appendix E: the arm is at its home when the controller starts"
    rows = (
        Row(
            JOINTS,
            (5e-4, 1e-3, 0.05),
            ("sensor.wrench", "arm.torque"),
            Loop("drive.encoder_offset"),
            Part.ARM,
        ),
    )


@final
@dataclass(frozen=True)
class SensorDrift(Effect):
    """One axis drifts steadily from the start of the run: W_i -> W_i + rate t."""

    rate: float = 0.0

    kind = "sensor_drift"
    sizes = (Size("rate", "N/s"),)
    source = "thesis 3.2.4, Appendix F: thermal drift, no numbers; moments in N m/s"
    rows = (Row(AXES, (2e-3, 0.01, 2.0), WRENCH, Loop("sensor.drift"), Part.SENSOR),)


@final
@dataclass(frozen=True)
class SensorWander(Effect):
    """One column wanders slowly: sum of p_k P_k(s), s from -1 to 1 over the file's stretch.

    P_k are Legendre polynomials from the first order on; the constant is an offset. The shape is
    of that stretch: between its rows it can be filled in, beyond its end it says nothing.
    """

    p1: float = 0.0
    p2: float = 0.0
    p3: float = 0.0
    p4: float = 0.0
    p5: float = 0.0
    p6: float = 0.0

    kind = "sensor_wander"
    sizes = tuple(Size(f"p{k + 1}", "") for k in range(6))
    anywhere = Anywhere(
        Element.SIGNAL, lambda p: p.span, lambda p: 0.0002 * p.span, linear=True, transient=True
    )

    @classmethod
    def magnitudes_at(cls, place: Place) -> tuple[Magnitude, ...]:
        """Up to the typical range each, as many terms as the file says."""
        return super().magnitudes_at(place)[: place.terms]

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """Add the wander."""
        s = 2.0 * (time - place.begin) / (place.end - place.begin) - 1.0
        weights = np.array([0.0, *self.values.values()])
        return added(reading, self.column, legvander(s, len(weights) - 1) @ weights)


@final
@dataclass(frozen=True)
class SensorMounting(Effect):
    """The sensor sits turned on its plate by a small angle about one of its axes."""

    angle: float = 0.0

    kind = "sensor_mounting"
    sizes = (Size("angle", "rad"),)
    source = "assumed; dowel pins leave about half a milliradian"
    rows = (
        Row(("sensor.rx", "sensor.ry", "sensor.rz"), (5e-4, 1e-3, 0.05), WRENCH, part=Part.SENSOR),
    )

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Turn the measuring site about its own axis."""
        if self.neutral:
            return
        import mujoco

        site = rig.site("sensor/wrench")
        turn, quat = np.zeros(4), np.zeros(4)
        mujoco.mju_axisAngle2Quat(turn, np.eye(3)[self.index], self.angle)
        mujoco.mju_mulQuat(quat, np.asarray(site.quat), turn)
        site.quat = quat


@final
@dataclass(frozen=True)
class SensorLag(Effect):
    """The low-pass is slower than it should be: its corner falls to f / (1 + slowness)."""

    slowness: float = 0.0

    kind = "sensor_lag"
    sizes = (Size("slowness", "1", Sign.POSITIVE),)
    source = "assumed; tolerance of an analog filter"
    proportional = False
    rows = (
        Row(
            ("sensor",), (0.02, 0.05, 3.0), WRENCH, Table("sensor.corner", Law.DIVIDE), Part.SENSOR
        ),
    )


@final
@dataclass(frozen=True)
class SensorDelay(Effect):
    """A signal, or all of a part, is read late, on VES II behind the low-pass: W(t - delay)."""

    delay: float = 0.0

    kind = "sensor_delay"
    sizes = (Size("delay", "s", Sign.POSITIVE),)
    source = "assumed; conversion and transfer by the sensor's own electronics"
    proportional = False
    rows = (Row(("sensor",), (0.0, 5e-4, 0.02), WRENCH, Loop("late.wrench.delay"), Part.CLOCK),)
    # 50 ms: assumed, a slow fieldbus and its filters
    anywhere = Anywhere(Element.SIGNAL, 0.05, 1e-4, columns=0)

    def edit_reading(
        self, reading: FloatArray, true: FloatArray, time: FloatArray, place: Place
    ) -> FloatArray:
        """What was read a delay ago."""
        return shifted(reading, time, self.delay)

    def undo_reading(self, reading: FloatArray, time: FloatArray, place: Place) -> FloatArray:
        """What is read a delay later, the last value held."""
        return shifted(reading, time, -self.delay)
