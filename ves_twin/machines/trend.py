"""trend: recordings of a machine on different days to what changed."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend import trend as core
from ves_twin.diagnosis.trend.calendar import Calendar
from ves_twin.diagnosis.trend.result import Trend
from ves_twin.machines.diagnose import prepare, settings_of
from ves_twin.machines.load import Given, machine_of, named
from ves_twin.machines.machine import Material, Named
from ves_twin.scenario.experiment_file import ExperimentFile


def trend(
    recordings: Sequence[Recording | Named],
    plant: Given = None,
    *,
    calendar: Calendar,
    standstill: Recording | None = None,
    exclude: Sequence[str] = (),
    cause: str = "",
    false_alarm: float = core.ALPHA,
    experiment: ExperimentFile | None = None,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Trend:
    """Follow one cause of a machine from day to day; see `ves_twin.diagnosis.trend`.

    Args:
        recordings: of one machine.
        plant: the machine, or its name or file; VES II as it was recorded if left out.
        calendar: date of each recording.
        standstill: the machine standing still, which tells the noise.
        exclude: causes that are not considered, by kind or kind@target.
        cause: kind@target to follow without asking which.
        false_alarm: rate of false alarms of the whole series.
        experiment: how they were made, as far as they do not say so themselves.
        settings: how sure; the machine may set what its size asks.
        progress: told what is being done.

    Raises:
        InvalidInputError: recordings that cannot be compared, or too few.
        UnknownNameError: an unknown cause, or a signal that is not recorded.
    """
    material = Material(named(recordings, "recording"), standstill=standstill)
    prepared = prepare(machine_of(plant), material, experiment)
    machine = prepared.machine
    measured = [one.recording for one in prepared.material.measured]
    return core.trend(
        machine.forward,
        measured,
        calendar,
        standstill=prepared.material.standstill,
        exclude=machine.causes(exclude),
        cause=cause,
        false_alarm=false_alarm,
        settings=settings_of(machine, settings, measured[0]),
        progress=progress,
    )
