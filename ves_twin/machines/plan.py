"""plan: what a recording of a machine could and could not find, before it is made."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.diagnosis.experiment.plan import Plan, check_channels, plan_recording
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.load import Given, machine_of


def plan(
    plant: Given = None,
    excitation: str = "",
    *,
    channels: Sequence[str] = (),
    seconds: float | None = None,
    quick: bool = False,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Plan:
    """What recordings of an excitation could tell, with noise and tolerances as declared.

    Args:
        plant: the machine, or its name or file; VES II as the scenario has it if left out.
        excitation: a scenario of VES II, an excitation that the machine offers, or a recording
            whose inputs are fed in; the machine's first choice if empty.
        channels: signals or columns that would be recorded; all if none are given.
        seconds: how much of it would be recorded; all if left out.
        quick: take the threshold of white noise, without simulating machines in order.
        settings: how sure, where banks are kept; the machine may set what its size asks.
        progress: told what is being done.

    Raises:
        VesTwinError: an excitation or a channel that does not exist, or a time that is too short.
    """
    progress(0.0, "set-points")
    machine, fed = machine_of(plant).excitation(excitation, seconds)
    check_channels(machine.forward, channels)
    return plan_recording(
        machine.forward,
        fed,
        channels=channels,
        seconds=seconds,
        quick=quick,
        settings=machine.settings(settings or Settings(), fed),
        progress=progress,
    )
