"""Effects of the six-axis force sensor: gain, cross-talk, drift, mounting, low-pass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, final

from ves_twin.effects.effect import AXES, Effect
from ves_twin.effects.magnitude import Magnitude, Sign

if TYPE_CHECKING:
    import mujoco
    import numpy as np

_PAIRS = tuple(f"{to}.{of.removeprefix('sensor.')}" for to in AXES for of in AXES if to != of)
_TURNS = ("sensor.rx", "sensor.ry", "sensor.rz")


@final
@dataclass(frozen=True)
class SensorGain(Effect):
    """One axis reads too much: W_i -> (1 + gain) W_i, after cross-talk."""

    gain: float = 0.0

    kind: ClassVar[str] = "sensor_gain"
    targets: ClassVar[tuple[str, ...]] = AXES
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("gain", "1", 0.001, 0.003, 0.2),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "thesis 3.2.4 (electronics gain); size as catalogues of such sensors"

    def edit_loop(self, parameters: np.void) -> None:
        """Scale a row of the signal matrix."""
        parameters["sensor"]["gain"][self.index] *= 1.0 + self.gain


@final
@dataclass(frozen=True)
class SensorCrossTalk(Effect):
    """One axis reads a share of another's load: W_i -> W_i + share (r_i / r_j) W_j.

    r is the range of an axis, so that a share of 0.01 is one per cent of full scale whatever the
    units. Target "sensor.mx.fz" is the moment about x reading the force along z.
    """

    share: float = 0.0

    kind: ClassVar[str] = "sensor_cross_talk"
    targets: ClassVar[tuple[str, ...]] = _PAIRS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("share", "1", 0.0005, 0.002, 0.1),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "thesis 3.2.4 (repeatable, linear, removed by a calibration matrix)"

    def edit_loop(self, parameters: np.void) -> None:
        """Add an entry off the diagonal of the signal matrix."""
        _, to, of = self.target.split(".")
        i, j = AXES.index(f"sensor.{to}"), AXES.index(f"sensor.{of}")
        sensor = parameters["sensor"]
        sensor["gain"][i, j] += self.share * sensor["range"][i] / sensor["range"][j]


@final
@dataclass(frozen=True)
class SensorDrift(Effect):
    """One axis drifts steadily from the start of the run: W_i -> W_i + rate t."""

    rate: float = 0.0

    kind: ClassVar[str] = "sensor_drift"
    targets: ClassVar[tuple[str, ...]] = AXES
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("rate", "N/s", 2e-3, 0.01, 2.0),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "thesis 3.2.4, Appendix F: thermal drift, no numbers; moments in N m/s"

    def edit_loop(self, parameters: np.void) -> None:
        """Add to the drift of the axis."""
        parameters["sensor"]["drift"][self.index] += self.rate


@final
@dataclass(frozen=True)
class SensorMounting(Effect):
    """The sensor sits turned on its plate by a small angle about one of its axes."""

    angle: float = 0.0

    kind: ClassVar[str] = "sensor_mounting"
    targets: ClassVar[tuple[str, ...]] = _TURNS
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (Magnitude("angle", "rad", 5e-4, 1e-3, 0.05),)
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "assumed; dowel pins leave about half a milliradian"

    def edit_rig(self, rig: mujoco.MjSpec) -> None:
        """Turn the measuring site about its own axis."""
        if self.neutral:
            return
        import mujoco
        import numpy as np

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

    kind: ClassVar[str] = "sensor_lag"
    targets: ClassVar[tuple[str, ...]] = ("sensor",)
    magnitudes: ClassVar[tuple[Magnitude, ...]] = (
        Magnitude("slowness", "1", 0.02, 0.05, 3.0, Sign.POSITIVE),
    )
    channels: ClassVar[tuple[str, ...]] = ("sensor.wrench",)
    source: ClassVar[str] = "assumed; tolerance of an analog filter"

    def edit_numbers(self, numbers: dict[str, np.ndarray]) -> None:
        """Lower the corner of the low-pass."""
        numbers["sensor.corner"] /= 1.0 + self.slowness
