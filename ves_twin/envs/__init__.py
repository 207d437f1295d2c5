"""envs: rig and machines as Gymnasium environments; importing this room registers them."""

from __future__ import annotations

import gymnasium as gym

from ves_twin.envs.admittance_tuning import AdmittanceTuning
from ves_twin.envs.capture import MicrogravityCapture
from ves_twin.envs.damping import VibrationDamping
from ves_twin.envs.gravity_compensation import GravityCompensation
from ves_twin.envs.reach import VibrationFreeReach
from ves_twin.envs.tracking import PlatformTracking

RIG_ENVIRONMENTS = {
    "VesTwin/VibrationFreeReach-v0": "ves_twin.envs.reach:VibrationFreeReach",
    "VesTwin/VibrationDamping-v0": "ves_twin.envs.damping:VibrationDamping",
    "VesTwin/PlatformTracking-v0": "ves_twin.envs.tracking:PlatformTracking",
    "VesTwin/AdmittanceTuning-v0": "ves_twin.envs.admittance_tuning:AdmittanceTuning",
    "VesTwin/GravityCompensation-v0": "ves_twin.envs.gravity_compensation:GravityCompensation",
    "VesTwin/MicrogravityCapture-v0": "ves_twin.envs.capture:MicrogravityCapture",
}
"""Id -> entry point of those with a rig of VES II."""

ENVIRONMENTS = {
    **RIG_ENVIRONMENTS,
    "VesTwin/DiagnoseAndRetune-v0": "ves_twin.envs.diagnose_and_retune:DiagnoseAndRetune",
}
"""Id -> entry point; what needs the diagnosis is imported when it is made. A change of what an
episode does asks for a new version of its id."""

for _id, _entry_point in ENVIRONMENTS.items():
    gym.register(_id, entry_point=_entry_point)

__all__ = [
    "ENVIRONMENTS",
    "RIG_ENVIRONMENTS",
    "AdmittanceTuning",
    "GravityCompensation",
    "MicrogravityCapture",
    "PlatformTracking",
    "VibrationDamping",
    "VibrationFreeReach",
]
