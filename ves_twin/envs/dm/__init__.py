"""dm: the environments as `dm_control.rl.control.Environment`, loaded as dm_control.suite does."""

from ves_twin.envs.dm.load import ALL_TASKS, TASKS_BY_DOMAIN, control_environment, load
from ves_twin.envs.dm.rig_physics import RigPhysics
from ves_twin.envs.dm.rig_task import RigTask

__all__ = [
    "ALL_TASKS",
    "TASKS_BY_DOMAIN",
    "RigPhysics",
    "RigTask",
    "control_environment",
    "load",
]
