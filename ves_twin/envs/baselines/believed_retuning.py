"""BelievedRetuning: the controller tuned on the machine as it is believed to be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import final

from ves_twin.core.recording.recording import Recording
from ves_twin.envs.baselines.retuning import Retuning
from ves_twin.machines.mjcf.rig.machine import Rig


@final
class BelievedRetuning(Retuning):
    """What tuning in simulation gives without looking at an experiment."""

    def twin(self, records: Sequence[Recording]) -> tuple[Rig, Mapping[str, float]]:
        """The believed machine."""
        return self.known.task.rig, {}
