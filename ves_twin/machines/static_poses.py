"""StaticPoses: the force sensor read at poses at rest, as the diagnosis sees it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.signals import SIGNALS
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.model.forward import Channel, Excitation, Hypothesis, Parameter
from ves_twin.mechanics.gravity.gravity_model import GravityModel
from ves_twin.mechanics.gravity.observations import to_sensor_matrix
from ves_twin.plant.plant import Plant

DRIVE = ("platform.pose", "arm.q")
READ = SIGNALS["sensor.wrench"]

MASS_SD, MOMENT_SD = 0.02, 0.5
"""Share of the payload's mass, and first moments [kg m], that weighing and drawings leave open
(assumed: 5 mm at 94 kg)."""

TILT = (2e-4, 0.03)
"""Tilts of interest [rad]: a tenth of a newton of the payload's weight, to 1.7 deg."""


def tilt_name(pose: int, axis: str) -> str:
    """Parameter of the orientation error of a pose, numbered from 1, about x or y."""
    return f"tilt.{axis}.{pose}"


@dataclass(frozen=True)
class StaticPoses:
    """s = A w(q, R) + b + d k at pose k: gain and cross-talk A, payload w, zero b, drift d a pose.

    The platform's angles are those that it is taken to have, plus what a cause adds: a tilt at each
    pose by itself, or one tilt of the base at all. Gravity does not see a turn about Z.

    Attributes:
        plant: the nominal rig: payload, sensor, noise.
        count: of poses.
        averaged: time over which a pose is read [s].
    """

    plant: Plant
    count: int
    averaged: float

    @cached_property
    def identity(self) -> str:
        """Changes with the plant and the library."""
        parts = (self.plant.hash, self.count, self.channels, self.parameters, self.hypotheses)
        return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]

    @property
    def drive(self) -> tuple[str, ...]:
        """The pose that the platform is taken to have, and the joint angles."""
        return DRIVE

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """The sensor's axes; noise is that of a mean over some correlation times, and the slow."""
        array, number = self.plant.parameters.array, self.plant.parameters.number
        independent = max(2.0 * number("sensor.corner") * self.averaged, 1.0)
        sd = np.hypot(array("sensor.wander"), array("sensor.noise") / np.sqrt(independent))
        columns = zip(READ.columns, READ.units, sd, strict=True)
        return tuple(
            Channel(name, READ.name, i, unit, float(s)) for i, (name, unit, s) in enumerate(columns)
        )

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """Payload, gains and zero with what commissioning leaves open; then what causes add."""
        model, table = self._payload, self.plant.parameters
        known = [
            Parameter("payload.mass", "kg", model.total_mass, 1.0, 1e3, MASS_SD * model.total_mass)
        ]
        for name, value in zip(model.basis.names, model.moments, strict=True):
            label = f"payload.{name.replace(' ', '.')}"
            known.append(Parameter(label, "kg*m", float(value), -1e3, 1e3, MOMENT_SD))
        gain_sd, zero_sd = table["sensor.crosstalk"].sd, table["sensor.offset"].sd
        for i, axis in enumerate(READ.axes):
            for j, of in enumerate(READ.axes):
                sd = float(np.broadcast_to(gain_sd, (6, 6))[i, j])
                known.append(Parameter(f"gain.{axis}.{of}", "1", 0.0, -0.2, 0.2, sd))
            sd = float(np.broadcast_to(zero_sd, 6)[i])
            nominal = float(table.array("sensor.offset")[i])
            known.append(Parameter(f"zero.{axis}", READ.units[i], nominal, -1e3, 1e3, sd))
        for axis, unit in zip(READ.axes, READ.units, strict=True):
            known.append(Parameter(f"drift.{axis}", unit, 0.0, -10.0, 10.0))
        known += [Parameter(name, "rad", 0.0, -0.2, 0.2) for name in _ENCODERS]
        known += [Parameter(name, "rad", 0.0, -0.1, 0.1) for name in (*_BASE, *self._tilts)]
        return tuple(known)

    @cached_property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """What a laboratory would suspect where a calibration stalls."""
        mass, source = self._payload.total_mass, "thesis 3.4.5; sizes assumed"
        many = len(self._tilts)
        return (
            Hypothesis("payload_mass", "payload", ("payload.mass",), (0.1,), (0.3 * mass,)),
            *(
                Hypothesis("sensor_drift", f"sensor.{a}", (f"drift.{a}",), (0.005,), (2.0,))
                for a in READ.axes
            ),
            *(
                Hypothesis(
                    "encoder_offset", name.removeprefix("encoder."), (name,), (5e-4,), (0.1,)
                )
                for name in _ENCODERS
            ),
            Hypothesis("base_tilt", "base", _BASE, TILT[:1] * 2, TILT[1:] * 2, source=source),
            Hypothesis(
                "orientation_error",
                "each pose",
                self._tilts,
                TILT[:1] * many,
                TILT[1:] * many,
                source=source,
            ),
        )

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> FloatArray:
        """Readings (n, 6) at the programme's poses; there is no step that could be refined."""
        value = self._nominal | dict(values)
        first, axes = self._payload, READ.axes
        moments = np.array([value[name] for name in self._moments])
        model = GravityModel(first.basis, value["payload.mass"], moments, first.gravity)
        order = np.round(programme.time).astype(int)
        tilts = np.array([[value[tilt_name(k + 1, a)] for a in "xy"] + [0.0] for k in order])
        base = np.array([value[name] for name in _BASE] + [0.0])
        q = programme.drive["arm.q"] + [value[name] for name in _ENCODERS]
        in_top = model.wrench_in_top(q, programme.drive["platform.pose"][:, 3:] + tilts + base)
        wrench = in_top @ self._to_sensor.T
        share = np.array([[value[f"gain.{i}.{j}"] for j in axes] for i in axes])
        scale = self.plant.parameters.array("sensor.range")
        gain = np.eye(6) + share * np.outer(scale, 1.0 / scale)
        zero = np.array([value[f"zero.{axis}"] for axis in axes])
        drift = np.array([value[f"drift.{axis}"] for axis in axes])
        return np.asarray(wrench @ gain.T + zero + np.outer(order, drift))

    @cached_property
    def _payload(self) -> GravityModel:
        return self.plant.gravity_model

    @cached_property
    def _nominal(self) -> dict[str, float]:
        return {p.name: p.nominal for p in self.parameters}

    @cached_property
    def _moments(self) -> tuple[str, ...]:
        return tuple(f"payload.{name.replace(' ', '.')}" for name in self._payload.basis.names)

    @cached_property
    def _to_sensor(self) -> FloatArray:
        return to_sensor_matrix(self.plant.parameters.array("sensor.position"))

    @cached_property
    def _tilts(self) -> tuple[str, ...]:
        return tuple(tilt_name(k + 1, axis) for k in range(self.count) for axis in "xy")


_BASE = ("base.x", "base.y")
_ENCODERS = ("encoder.q1", "encoder.q2", "encoder.q3")
