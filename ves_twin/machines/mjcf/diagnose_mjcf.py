"""diagnose_mjcf: recordings of any rig to a verdict and, where it names causes, an extended rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.refusal import refusal
from ves_twin.diagnosis.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Verdict
from ves_twin.machines.mjcf.extend import extended
from ves_twin.machines.mjcf.forward import MjcfForward
from ves_twin.machines.mjcf.machine import Rig

WORTH_A_PROCESS = 0.3
"""Time of one prediction [s] from which other processes, which take seconds to begin, pay."""


@dataclass(frozen=True)
class MjcfDiagnosis:
    """What was found, and the rig that has it.

    Attributes:
        verdict: with the sizes of the effects as the names of its parameters.
        extended: the rig with the causes and the tuned numbers; None where no causes are named.
        refused: why the extension is only a candidate; empty where it passed.
        nearest: the rig with what comes nearest where no causes are named; None if nothing does.
    """

    verdict: Verdict
    extended: Rig | None
    refused: str
    nearest: Rig | None = None


def diagnose_mjcf(
    recordings: Sequence[Recording],
    rig: Rig,
    *,
    held_out: Sequence[Recording] = (),
    commissioning: Sequence[Recording] = (),
    standstill: Recording | None = None,
    baseline: Sequence[Recording] = (),
    exclude: Sequence[str] = (),
    settings: Settings | None = None,
    progress: Progress = silent,
) -> MjcfDiagnosis:
    """Name what the simulation of a rig gets wrong in recordings of it.

    Args:
        recordings: what was measured; together one record.
        rig: the two files.
        held_out: other recordings, on which an extension must prove itself; beyond two causes
            each must prove itself there.
        commissioning: recordings of healthy rigs, or of this one mounted anew.
        standstill: the rig standing still, which tells the noise.
        baseline: of this rig in order, with the same signals fed in; see `diagnose`.
        exclude: causes that are not considered, by kind or kind@target.
        settings: how sure, how many; rate and number of causes are those of the rig's file.
        progress: told what is being done.

    Raises:
        InvalidInputError: recordings that cannot be compared.
        UnknownNameError: an unknown cause in `exclude`, or a signal that is not recorded.
    """
    told = rig.description
    forward = MjcfForward.of(rig)
    for recording in recordings:
        forward.check_noise(recording.signals)
    chosen = replace(settings or Settings(), rate=told.rate, causes=told.causes)
    if recordings and is_quick(forward, recordings[0], told.rate):
        chosen = replace(chosen, workers=1)
    verdict = diagnose(
        forward,
        recordings,
        held_out=held_out,
        commissioning=commissioning,
        standstill=standstill,
        baseline=baseline,
        exclude=exclude,
        settings=chosen,
        progress=progress,
    )
    new = extended(rig, verdict) if verdict.verdict.names_a_plant else None
    near = extended(rig, replace(verdict, causes=verdict.nearest)) if verdict.nearest else None
    verdict = replace(
        verdict,
        causes=tuple(c.shortened for c in verdict.causes),
        nearest=tuple(c.shortened for c in verdict.nearest),
    )
    if new is None:
        return MjcfDiagnosis(verdict, None, f"the verdict is {verdict.verdict.value}", near)
    return MjcfDiagnosis(verdict, new, refusal(verdict))


def is_quick(forward: MjcfForward, recording: Recording, rate: float) -> bool:
    """Whether a prediction takes less than it takes to hand it to another process."""
    programme = Excitation.of(recording, forward.drive, rate=rate)
    begin = perf_counter()
    forward.simulate(programme, {})
    return perf_counter() - begin < WORTH_A_PROCESS
