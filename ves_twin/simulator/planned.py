"""planned_experiment: what a learned gravity wrench must belong to, from a scenario."""

from __future__ import annotations

import numpy as np

from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.gravity.learned import PlannedExperiment
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.arm_commands import arm_motion
from ves_twin.simulator.clock import Clock


def planned_experiment(scenario: Scenario, plant: Plant) -> PlannedExperiment:
    """Commands, emulated system, sensor and rate of a scenario.

    Raises:
        InvalidInputError: an operator commands the arm, or nothing is emulated.
    """
    if scenario.arm.operator is not None:
        raise InvalidInputError(
            "gravity",
            f"the Learning Method with arm.operator = {scenario.arm.operator!r}",
            "the Model Method: commands of an operator are not known in advance",
        )
    if scenario.platform.emulated is None:
        raise InvalidInputError("gravity", "the Learning Method", "platform.emulated with it")
    system = EmulatedSystem.load(scenario.platform.emulated)
    clock = Clock.of(scenario, plant.parameters)
    period = clock.admittance * clock.tick
    motion = arm_motion(scenario)
    count = int(np.ceil(scenario.run.duration / period))
    return PlannedExperiment(
        sensor=plant.sensor_identity,
        system=f"{system.name} ({system.identity})",
        start=scenario.platform.start,
        period=period,
        commands=np.array([motion.q(k * period) for k in range(count)]),
    )
