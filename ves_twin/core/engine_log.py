"""log_engine: MuJoCo's warnings to Python's logging; by itself it writes a file where it stands."""

from __future__ import annotations

import logging

import mujoco

_LOGGER = logging.getLogger("ves_twin.mujoco")


def log_engine() -> None:
    """Hand MuJoCo's warnings to the logger `ves_twin.mujoco`, at level INFO.

    They belong to the process, so that what somebody else has chosen for them stays. That a motion
    diverged is told by the run's outcome.
    """
    if mujoco.get_mju_user_warning() is None:
        mujoco.set_mju_user_warning(_LOGGER.info)
