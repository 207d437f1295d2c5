"""DrawnRig: the compiled rig that a recording is drawn with."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.effects.registry import parse_effects
from ves_twin.mechanics.kinematics.stewart import StewartGeometry
from ves_twin.plant.assembly import assemble, compile_model
from ves_twin.plant.layout import Layout
from ves_twin.plant.plant import Plant

DEFAULT_PLANT = "ves2"
DRAWING_STEP = 1e-3
"""Physics step of the drawn model [s]; it is placed by kinematics and never stepped."""


@dataclass(frozen=True)
class DrawnRig:
    """The machine as bodies and geoms, without dynamics.

    Attributes:
        model: compiled MuJoCo model; lengths in m, poses in the inertial frame.
        layout: where its coordinates lie.
        geometry: joint positions of the platform.
        note: what differs from the rig of the recording, empty if nothing does.
    """

    model: mujoco.MjModel
    layout: Layout
    geometry: StewartGeometry
    note: str

    @staticmethod
    def of(info: RecordingInfo) -> DrawnRig:
        """The rig that a recording names; the default one, with a note, if it is not found.

        A fast rig is drawn with the legs of the full one, which it is the same machine as.
        """
        plant, note = _plant_of(info)
        model = compile_model(assemble(plant.with_fidelity("full"), DRAWING_STEP))
        return DrawnRig(model, Layout.of(model), plant.geometry, note)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies, in MuJoCo's order, the world left out."""
        return tuple(self.model.body(i).name for i in range(1, self.model.nbody))


def settings_of(info: RecordingInfo) -> Mapping[str, object]:
    """The scenario of a recording as plain values; empty if it has none."""
    try:
        content = json.loads(info.settings or "{}")
    except ValueError:
        return {}
    return content if isinstance(content, dict) else {}


def _plant_of(info: RecordingInfo) -> tuple[Plant, str]:
    try:
        plant = Plant.load(info.plant_base or info.plant or DEFAULT_PLANT)
        plant = plant.with_values(info.parameters).extended(*parse_effects(info.effects))
    except VesTwinError as error:
        return Plant.load(DEFAULT_PLANT), f"The drawing shows {DEFAULT_PLANT}: {error}"
    if info.plant_hash and plant.hash != info.plant_hash:
        return plant, f"The drawing shows plant hash {plant.hash}: the plant has changed since"
    return plant, ""
