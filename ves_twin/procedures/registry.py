"""load_procedure: a procedure by the name of its file, checked against its class."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import ValidationError

from ves_twin.core.errors import UnknownNameError
from ves_twin.procedures.calibrate_plant import CalibratePlant
from ves_twin.procedures.calibrate_poses import CalibratePoses
from ves_twin.procedures.coupling_map_paths import CouplingMapPaths
from ves_twin.procedures.emulation_error_budget import EmulationErrorBudget
from ves_twin.procedures.frequency_response import FrequencyResponseTest
from ves_twin.procedures.frozen_droop import FrozenDroop
from ves_twin.procedures.gravity_sensitivity import GravitySensitivity
from ves_twin.procedures.learning_method import LearningMethod
from ves_twin.procedures.methods_agreement import MethodsAgreement
from ves_twin.procedures.positioning_error import PositioningErrorTest
from ves_twin.procedures.pped_release import PpedRelease
from ves_twin.procedures.pped_release_emulated import PpedReleaseEmulated
from ves_twin.procedures.procedure import Procedure
from ves_twin.procedures.sensor_drift import SensorDrift
from ves_twin.procedures.showcase import Showcase
from ves_twin.procedures.showcase_droop import DroopShowcase
from ves_twin.procedures.stability_map import StabilityMap
from ves_twin.procedures.verify_gravity import VerifyGravity
from ves_twin.scenario.load import refusal, scenario_content

PROCEDURES: dict[str, type[Procedure]] = {
    "coupling_map_paths": CouplingMapPaths,
    "pped_release": PpedRelease,
    "pped_release_emulated": PpedReleaseEmulated,
    "frequency_response": FrequencyResponseTest,
    "positioning_error": PositioningErrorTest,
    "calibrate_poses": CalibratePoses,
    "frozen_droop": FrozenDroop,
    "gravity_sensitivity": GravitySensitivity,
    "emulation_error_budget": EmulationErrorBudget,
    "learning_method": LearningMethod,
    "methods_agreement": MethodsAgreement,
    "sensor_drift": SensorDrift,
    "showcase": Showcase,
    "showcase_droop": DroopShowcase,
    "verify_gravity": VerifyGravity,
    "calibrate_plant": CalibratePlant,
    "stability_map": StabilityMap,
}
"""Value of `procedure` in a file -> class."""


def load_procedure(
    name_or_path: str, changes: Mapping[str, object] | None = None
) -> Procedure | None:
    """A procedure by name or from a file; None where the file is an ordinary scenario.

    Args:
        name_or_path: a name of scenarios/, or a path to a TOML file.
        changes: dotted keys to values.

    Raises:
        FileAccessError: missing or unreadable file.
        UnknownNameError: unknown file, procedure or key; says the nearest one.
        InvalidInputError: wrong type, unit, shape or range; says the key.
    """
    content, where = scenario_content(name_or_path, changes or {})
    kind = content.get("procedure")
    if kind is None:
        return None
    if not isinstance(kind, str) or kind not in PROCEDURES:
        raise UnknownNameError(f"procedure in {where}", str(kind), PROCEDURES)
    model = PROCEDURES[kind]
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise refusal(error, where, model) from None
