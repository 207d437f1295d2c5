"""add_channel: which further sensor would tell causes of a machine apart."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.diagnosis.experiment.further_channel import Further, further_channels
from ves_twin.diagnosis.experiment.plan import columns_of
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.load import Given, machine_of


def add_channel(
    plant: Given = None,
    excitation: str = "",
    *,
    channels: Sequence[str] = (),
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Further:
    """Rank the sensors that are not recorded by what they tell of the causes confused now.

    Args:
        plant: the machine, or its name or file; VES II as the scenario has it if left out.
        excitation: as `plan`.
        channels: signals or columns that are recorded anyway; the machine's own if none are given.
        settings: how sure, where banks are kept; the machine may set what its size asks.
        progress: told what is being done.

    Raises:
        VesTwinError: an excitation or a channel that does not exist, no further sensor, or no
            causes that are confused.
    """
    progress(0.0, "set-points")
    machine, fed = machine_of(plant).excitation(excitation)
    recorded = columns_of(machine.forward, channels)
    chosen = machine.settings(settings or Settings(), fed)
    return further_channels(machine.further(), fed, recorded, settings=chosen, progress=progress)
