"""Registry: the platform controllers and gravity compensations that a scenario can name."""

from __future__ import annotations

from collections.abc import Callable

from ves_twin.control.admittance import AdmittanceController
from ves_twin.control.controller import PlatformController
from ves_twin.control.gravity import (
    GravityCompensation,
    GravityTask,
    ModelCompensation,
    NoCompensation,
    TruthCompensation,
)
from ves_twin.control.played import learned_wrench
from ves_twin.control.position import PositionController
from ves_twin.core.plugins import Registry, lacks

PLATFORM_CONTROLLERS: Registry[type[PlatformController]] = Registry(
    "ves_twin.controllers",
    {
        "position": PositionController,
        "admittance": AdmittanceController,
        "micro_gravity": AdmittanceController,
    },
    lacks(PlatformController),
)
"""Operating mode (thesis 2.2) -> controller; the last two differ in the gravity estimate."""

GRAVITY_COMPENSATIONS: Registry[Callable[[GravityTask], GravityCompensation]] = Registry(
    "ves_twin.gravity",
    {
        "none": lambda task: NoCompensation(),
        "truth": lambda task: TruthCompensation(task.truth),
        "learned": learned_wrench,
        "model": lambda task: ModelCompensation(task.belief),
    },
    lambda loaded: None if callable(loaded) else "cannot be called",
)
"""Method -> compensation, given the belief and the truth port that only the test method opens."""
