"""signal_ranges: values that the signals of a plant can have, from its strokes and ranges."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray
from ves_twin.mechanics.kinematics.stewart import leg_lengths
from ves_twin.plant.plant import Plant

TILT = np.pi / 4.0
"""Platform angles stay below this [rad]: the legs' stroke ends earlier."""


def signal_ranges(plant: Plant) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Least and largest value of each column, by signal, in SI.

    Legs: home length and half a stroke. Sensor: its range. Arm: one turn either way, and the
    torque limit of the drives. Supply: a tenth of the nominal pressure to twice of it.
    """
    array, number = plant.parameters.array, plant.parameters.number
    g = plant.geometry
    home, half = leg_lengths(np.zeros(6), g.base, g.top, g.home), number("leg.stroke") / 2.0
    legs = (home - half, home + half)
    reach = np.array([half, half, half, TILT, TILT, TILT])
    turn, torque, wrench = np.full(3, 2.0 * np.pi), array("arm.torque_limit"), array("sensor.range")
    supply = np.array([2.0 * number("supply.pressure")])
    return {
        "leg.command": legs,
        "leg.length": legs,
        "valve.command": (-np.ones(6), np.ones(6)),
        "platform.command": (-reach, reach),
        "platform.pose": (-reach, reach),
        "sensor.wrench": (-wrench, wrench),
        "gravity.estimate": (-wrench, wrench),
        "arm.command": (-turn, turn),
        "arm.q": (-turn, turn),
        "arm.torque": (-torque, torque),
        "supply.pressure": (0.05 * supply, supply),
    }
