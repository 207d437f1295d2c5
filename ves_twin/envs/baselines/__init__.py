"""baselines: policies to measure others against."""

from __future__ import annotations

from ves_twin.envs.baselines.believed_retuning import BelievedRetuning
from ves_twin.envs.baselines.chase import Chase
from ves_twin.envs.baselines.diagnosed_retuning import DiagnosedRetuning
from ves_twin.envs.baselines.fitted_retuning import FittedRetuning
from ves_twin.envs.baselines.fixed_tuning import FixedTuning
from ves_twin.envs.baselines.hot_spot_path import HotSpotPath
from ves_twin.envs.baselines.inertial_damper import InertialDamper
from ves_twin.envs.baselines.lag_feedforward import LagFeedforward
from ves_twin.envs.baselines.lqg import Lqg
from ves_twin.envs.baselines.mpc import Mpc
from ves_twin.envs.baselines.planned_path import PlannedPath
from ves_twin.envs.baselines.pped import Pped
from ves_twin.envs.baselines.residual_filter import ResidualFilter
from ves_twin.envs.baselines.still import Still
from ves_twin.envs.baselines.straight_path import StraightPath
from ves_twin.envs.baselines.trained import TrainedDamping
from ves_twin.envs.policy import Policy

BASELINES: dict[str, type[Policy]] = {
    "still": Still,
    "straight_path": StraightPath,
    "hot_spot_path": HotSpotPath,
    "planned_path": PlannedPath,
    "pped": Pped,
    "inertial_damper": InertialDamper,
    "lqg": Lqg,
    "mpc": Mpc,
    "trained": TrainedDamping,
    "lag_feedforward": LagFeedforward,
    "fixed_tuning": FixedTuning,
    "residual_filter": ResidualFilter,
    "chase": Chase,
    "believed_retuning": BelievedRetuning,
    "diagnosed_retuning": DiagnosedRetuning,
    "fitted_retuning": FittedRetuning,
}
"""Name on the command line -> policy."""

EXPERTS = {
    "VesTwin/VibrationFreeReach-v0": "planned_path",
    "VesTwin/VibrationDamping-v0": "lqg",
    "VesTwin/PlatformTracking-v0": "lag_feedforward",
    "VesTwin/AdmittanceTuning-v0": "fixed_tuning",
    "VesTwin/GravityCompensation-v0": "residual_filter",
    "VesTwin/MicrogravityCapture-v0": "chase",
    "VesTwin/DiagnoseAndRetune-v0": "diagnosed_retuning",
}
"""Environment -> the baseline with the best score of docs/environments.md that needs no network."""
