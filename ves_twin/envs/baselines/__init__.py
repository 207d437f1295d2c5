"""baselines: policies to measure others against."""

from __future__ import annotations

from ves_twin.envs.baselines.hot_spot_path import HotSpotPath
from ves_twin.envs.baselines.lag_feedforward import LagFeedforward
from ves_twin.envs.baselines.lqg import Lqg
from ves_twin.envs.baselines.planned_path import PlannedPath
from ves_twin.envs.baselines.pped import Pped
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
    "lqg": Lqg,
    "trained": TrainedDamping,
    "lag_feedforward": LagFeedforward,
}
"""Name on the command line -> policy."""

EXPERTS = {
    "VesTwin/VibrationFreeReach-v0": "planned_path",
    "VesTwin/VibrationDamping-v0": "lqg",
    "VesTwin/PlatformTracking-v0": "lag_feedforward",
}
"""Environment -> the baseline with the best score of docs/environments.md that needs no network."""
