"""measure_step: the legs' answer to a small step of heave, in the whole rig."""

from __future__ import annotations

import numpy as np

from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Legs, Scenario
from ves_twin.simulator.linear.leg_loop import leg_period
from ves_twin.simulator.linear.response import StepResponse
from ves_twin.simulator.simulate import simulate

HEAVE = 2
HEIGHT = 0.002
"""Of the step [m]."""


def measure_step(plant: Plant, legs: Legs, duration: float) -> StepResponse:
    """Step the commanded heave from rest, without noise, and take the mean of the legs.

    Args:
        plant: the world.
        legs: gains and filter place.
        duration: after the step [s].

    Returns:
        Measured length over the commanded step, from the leg cycle of the step on.
    """
    pose = [0.0] * 6
    pose[HEAVE] = HEIGHT
    changes: dict[str, object] = {
        "run.duration": duration,
        "run.log": "leg",
        "run.noise": False,
        "platform.rate": 1.0 / leg_period(plant.parameters),
        "platform.motion.amplitude": pose,
        "platform.motion.frequency": [0.0] * 6,  # a standing cosine: a step at t = 0
        "platform.motion.phase": [np.pi / 2.0] * 6,
        "platform.motion.fade": 0.0,
        "legs": legs.model_dump(mode="json"),
    }
    run = simulate(Scenario.load("position_sine", changes), plant)
    command, length = run["leg.command"], run["leg.length"]
    begin = int(np.flatnonzero(np.any(command != command[0], axis=1))[0])
    share = (length[begin:] - length[0]) / (command[-1] - command[0])
    return StepResponse(run.time[begin:] - run.time[begin], np.mean(share, axis=1))
