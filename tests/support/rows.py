"""The six rows of the peers' table: their data, made as they were made, and their answers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pendulum import BIAS, FRICTION, GAIN, LATE, PLANT, SDS, SPRING, STEP

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation

ROWS: dict[str, tuple[Mapping[str, float], str]] = {
    "none": ({}, "-"),
    "Coulomb friction": ({FRICTION: 0.15}, "0.15 N m"),
    "joint spring": ({SPRING: 0.5}, "0.5 N m/rad"),
    "sensor delay": ({LATE: 0.010}, "10 ms"),
    "encoder bias": ({BIAS: 0.020}, "20 mrad"),
    "torque gain": ({GAIN: 1 / 1.05}, "1/1.05"),
}
"""Hidden values of the data."""

EXPECTED = {
    "none": None,
    "Coulomb friction": "coulomb_friction",
    "joint spring": "joint_spring",
    "sensor delay": "sensor_delay",
    "encoder bias": "sensor_offset",
    "torque gain": "actuator_gain",
}

PEER = {
    "none": "No Issues Detected; damping 0.0500, mass 1.000",
    "Coulomb friction": "No Issues Detected; damping 0.0982, mass 0.989",
    "joint spring": "No Issues Detected; damping 0.0825, mass 1.906",
    "sensor delay": "No Issues Detected; damping 0.0499, mass 0.990",
    "encoder bias": "No Issues Detected; damping 0.0500, mass 0.999",
    "torque gain": "No Issues Detected; damping 0.0476, mass 0.958",
}
"""mujoco.sysid 4.0.0 on such data, fitting damping (0.05) and mass (1.0), as measured in the study
before this project; the extra that mujoco.sysid needs is not among this project's dependencies."""


def row_record(hidden: Mapping[str, float], seed: int = 0) -> Recording:
    """8 s at 500 Hz: sine plus chirp of torque, 1 mrad and 10 mrad/s of white noise."""
    time = STEP * np.arange(4000)
    chirp = 0.6 * np.sin(2 * np.pi * (0.2 + 3.0 * time / 16.0) * time)
    torque = (np.sin(2 * np.pi * 0.3 * time) + chirp)[:, None]
    fed = Excitation("chirp", time, {"joint.torque": torque})
    rows = PLANT.simulate(fed, hidden)
    rows = rows + np.random.default_rng(seed).normal(size=rows.shape) * SDS
    signals = {"joint.torque": torque, "joint.angle": rows[:, :1], "joint.rate": rows[:, 1:]}
    return Recording(time, signals, RecordingInfo("measured", scenario="chirp"))
