"""trend_mjcf: recordings of a rig of two files on different days to what changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend.calendar import Calendar
from ves_twin.diagnosis.trend.result import Trend
from ves_twin.diagnosis.trend.trend import ALPHA, trend
from ves_twin.machines.mjcf.diagnose_mjcf import is_quick
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig


def trend_mjcf(
    recordings: Sequence[Recording],
    rig: Rig,
    calendar: Calendar,
    *,
    standstill: Recording | None = None,
    exclude: Sequence[str] = (),
    cause: str = "",
    false_alarm: float = ALPHA,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Trend:
    """Follow one cause of a rig from day to day; see `trend`.

    Args:
        recordings: of one rig.
        rig: the two files.
        calendar: date of each recording.
        standstill: the rig standing still, which tells the noise.
        exclude: causes that are not considered, by kind or kind@target.
        cause: kind@target to follow without asking which.
        false_alarm: rate of false alarms of the whole series.
        settings: how sure; the rate of the analysis grid is that of the rig's file.
        progress: told what is being done.

    Raises:
        InvalidInputError: recordings that cannot be compared, or too few.
        UnknownNameError: an unknown cause, or a signal that is not recorded.
    """
    forward = MjcfForward.of(rig)
    for recording in recordings:
        forward.check_noise(recording.signals)
    chosen = replace(settings or Settings(), rate=rig.description.rate)
    if recordings and is_quick(forward, recordings[0], rig.description.rate):
        chosen = replace(chosen, workers=1)
    return trend(
        forward,
        recordings,
        calendar,
        standstill=standstill,
        exclude=exclude,
        cause=cause,
        false_alarm=false_alarm,
        settings=chosen,
        progress=progress,
    )
