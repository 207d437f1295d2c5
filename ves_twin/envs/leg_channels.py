"""leg_channels: what the tasks of the legs show of them, and how far a pose is from another."""

from __future__ import annotations

import math

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import POSE_LIMIT, POSE_UNITS, WRENCH_UNITS
from ves_twin.envs.channels import Channel
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.signal_bus import SignalBus

RADIUS = 0.3
"""Lever arm with which an angle counts as a length [m]; about the platform's joint circle."""

MILLIMETRE = 1e-3


def leg_channels(scenario: Scenario) -> tuple[Channel, ...]:
    """Pose, legs, valves, sensor and supply, with bounds of the scenario's belief."""
    array = Plant.load(scenario.belief).parameters.array
    travel, wrench = float(array("leg.stroke")) / 2.0, array("sensor.range")
    return (
        Channel.within(
            "platform.pose", POSE_UNITS, POSE_LIMIT, "pose from home by the leg lengths"
        ),
        Channel.within("leg.travel", ("m",) * 6, travel, "measured leg length less home"),
        Channel.within("leg.setpoint", ("m",) * 6, travel, "set-point in force less home"),
        Channel.within("valve.command", ("1",) * 6, 1.0, "spool command"),
        Channel.within("sensor.wrench", WRENCH_UNITS, wrench, "payload on platform, sensor axes"),
        Channel("supply.pressure", ("Pa",), np.zeros(1), np.array([3e7]), "gauge of the manifold"),
    )


def leg_readings(board: SignalBus, pose: FloatArray, home: FloatArray) -> dict[str, FloatArray]:
    """Their values: a board, the measured pose (6,) and the leg lengths at home [m] (6,)."""
    return {
        "platform.pose": pose,
        "leg.travel": board["leg.length"] - home,
        "leg.setpoint": board["leg.command"] - home,
        "valve.command": board["valve.command"],
        "sensor.wrench": board["sensor.wrench"],
        "supply.pressure": board["supply.pressure"],
    }


def distance(pose: FloatArray, reference: FloatArray) -> float:
    """sqrt(|translation|^2 + (RADIUS |angles|)^2) between two poses [mm]."""
    error = pose - reference
    error[3:] *= RADIUS
    return math.sqrt(error.dot(error)) / MILLIMETRE
