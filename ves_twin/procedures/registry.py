"""load_procedure: a procedure by the name of its file, checked against its class."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import cast

from pydantic import ValidationError

from ves_twin.core.errors import UnknownNameError
from ves_twin.core.refusal import refusal
from ves_twin.procedures.procedure import Procedure
from ves_twin.scenario.load import scenario_content

PROCEDURES = {
    "coupling_map_paths": "planning.coupling_map_paths.CouplingMapPaths",
    "pped_release": "planning.pped_release.PpedRelease",
    "pped_release_emulated": "planning.pped_release_emulated.PpedReleaseEmulated",
    "frequency_response": "response.frequency_response.FrequencyResponseTest",
    "positioning_error": "response.positioning_error.PositioningErrorTest",
    "calibrate_poses": "gravity.calibrate_poses.CalibratePoses",
    "frozen_droop": "gravity.frozen_droop.FrozenDroop",
    "gravity_sensitivity": "gravity.gravity_sensitivity.GravitySensitivity",
    "emulation_error_budget": "emulation.emulation_error_budget.EmulationErrorBudget",
    "learning_method": "emulation.learning_method.LearningMethod",
    "methods_agreement": "emulation.methods_agreement.MethodsAgreement",
    "sensor_drift": "gravity.sensor_drift.SensorDrift",
    "showcase": "showcase.Showcase",
    "showcase_droop": "gravity.showcase_droop.DroopShowcase",
    "verify_gravity": "gravity.verify_gravity.VerifyGravity",
    "calibrate_plant": "stability.calibrate_plant.CalibratePlant",
    "stability_map": "stability.stability_map.StabilityMap",
}
"""Value of `procedure` in a file -> its class; imported where one is asked for, since together they
import half of the twin."""


def procedure_class(kind: str) -> type[Procedure]:
    """The class behind a value of `procedure`."""
    module, _, name = PROCEDURES[kind].rpartition(".")
    found = importlib.import_module(f"ves_twin.procedures.{module}")
    return cast("type[Procedure]", getattr(found, name))


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
    model = procedure_class(kind)
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise refusal(error, where, model) from None
