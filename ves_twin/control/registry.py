"""Registry: the platform controllers and gravity compensations that a scenario can name."""

from __future__ import annotations

from collections.abc import Callable

from ves_twin.control.admittance import AdmittanceController
from ves_twin.control.controller import PlatformController
from ves_twin.control.gravity import (
    GravityCompensation,
    NoCompensation,
    TruthCompensation,
    TruthPort,
)
from ves_twin.control.position import PositionController

PLATFORM_CONTROLLERS: dict[str, type[PlatformController]] = {
    "position": PositionController,
    "admittance": AdmittanceController,
    "micro_gravity": AdmittanceController,
}
"""Operating mode (thesis 2.2) -> controller; the last two differ in the gravity estimate."""

GRAVITY_COMPENSATIONS: dict[str, Callable[[TruthPort], GravityCompensation]] = {
    "none": lambda port: NoCompensation(),
    "truth": TruthCompensation,
}
"""Method -> compensation, given the truth port that only the test method opens."""
