"""DiagnosedRetuning: the controller tuned on the machine that a diagnosis extended."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import final

from ves_twin.core.recording.recording import Recording
from ves_twin.envs.baselines.retuning import Retuning
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.rig.machine import Rig


@final
class DiagnosedRetuning(Retuning):
    """`vt.diagnose` of all experiments but the last, which is held out where there are two.

    The twin has the causes that are named; where none are, what comes nearest; else nothing.
    """

    def twin(self, records: Sequence[Recording]) -> tuple[Rig, Mapping[str, float]]:
        """The extended machine."""
        believed = self.known.task.rig
        if not records:
            return believed, {}
        count = max(1, len(records) - 1)
        found = diagnose(records[:count], MjcfMachine(believed), held_out=records[count:])
        twin = found.extended or found.nearest
        if not isinstance(twin, MjcfMachine):
            return believed, {}
        # the next trial begins as the believed machine does, not as a recording says
        told = twin.rig.description.model_copy(update={"start": believed.description.start})
        return replace(twin.rig, description=told), {}
