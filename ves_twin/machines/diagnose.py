"""diagnose: recordings of a machine to a verdict and, where it names causes, an extended one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ves_twin.core.budget import Budget
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis import diagnose as core
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.machines.carried import Carried
from ves_twin.machines.load import Given, machine_of, named
from ves_twin.machines.machine import Machine, Material, Named, Prepared
from ves_twin.machines.simulated import Simulated
from ves_twin.scenario.experiment_file import ExperimentFile


@dataclass(frozen=True)
class Diagnosis:
    """What was found, and the machine that has it.

    Attributes:
        verdict: with the magnitudes of the effects as the names of its parameters.
        machine: that was tried, as the experiment has it.
        extended: it with the causes, or with a law; None where no causes are named and no law is
            claimed.
        refused: why the extension is only a candidate; empty where it passed on held-out data.
        excitation: that should part the causes, where they cannot be told apart.
        nearest: it with what comes nearest, where no causes are named; None if nothing does.
        carried: what its MJCF file leaves on held-out recordings, where that has a part alone.
        simulated: what it leaves of held-out motions, where efforts were compared in their place.
    """

    verdict: Verdict
    machine: Machine
    extended: Machine | None
    refused: str
    excitation: Excitation | None = None
    nearest: Machine | None = None
    carried: Carried | None = None
    simulated: Simulated | None = None


def diagnose(
    recordings: Sequence[Recording | Named],
    plant: Given = None,
    *,
    held_out: Sequence[Recording | Named] = (),
    commissioning: Sequence[Recording | Named] = (),
    standstill: Recording | None = None,
    baseline: Sequence[Recording | Named] = (),
    exclude: Sequence[str] = (),
    experiment: ExperimentFile | None = None,
    alternate: float | None = None,
    settings: Settings | None = None,
    progress: Progress = silent,
    budget: Budget | None = None,
) -> Diagnosis:
    """Name what the simulation of a machine gets wrong in recordings of it.

    Args:
        recordings: what was measured; together one record.
        plant: the nominal machine, with the tolerances that commissioning left, or its name or
            file; VES II as it was recorded if left out.
        held_out: other recordings of the same machine, on which an extension must prove itself;
            beyond two causes each must prove itself there.
        commissioning: recordings of healthy machines, or of this one mounted anew.
        standstill: the machine standing still, which tells the noise. Legs that hunt over a count
            while they stand make more of it than in motion; then the declared noise is better.
        baseline: of this machine in order, with the same inputs; see `ves_twin.diagnosis`.
        exclude: causes that are not considered, by kind or kind@target.
        experiment: how they were made, as far as they do not say so themselves.
        alternate: hold out every second stretch of so many s, or poses; 0: the machine's own.
        settings: how sure, how many, where banks are kept; the machine may set what its size asks.
        progress: told what is being done.
        budget: time that it may take, which may be ended; that of the settings if left out.

    Raises:
        VesTwinError: recordings whose columns look swapped, turned or in other units.
        InvalidInputError: no recording, recordings that cannot be of one machine, or a held-out
            one that is fitted as well.
        UnknownNameError: an unknown cause in `exclude`, or an input that is not recorded.
    """
    given = _named(recordings, held_out, baseline, commissioning, standstill)
    prepared = prepare(machine_of(plant), given, experiment)
    _check_held_out(prepared.material)
    if alternate is not None:
        prepared = prepared.split(alternate)
    whole, prepared = len(prepared.material.measured), prepared.in_pieces()
    machine, material = prepared.machine, prepared.material
    measured = [one.recording for one in material.measured]
    offered: list[Excitation] = []

    def menu() -> list[Excitation]:
        offered.extend(machine.excitations(measured[0]))
        return offered

    left_out = [one.recording for one in material.held_out]
    chosen = settings_of(machine, settings, measured[0])
    verdict = core.diagnose(
        machine.forward,
        measured,
        held_out=left_out,
        commissioning=[one.recording for one in material.commissioning],
        standstill=material.standstill,
        baseline=[one.recording for one in material.baseline],
        next_programmes=menu,
        exclude=machine.causes(exclude),
        settings=chosen,
        progress=progress,
        budget=budget,
    )
    cut = len(measured) if len(measured) > whole else 0
    basis = replace(verdict.basis, recordings=_origin(given), pieces=cut)
    verdict = replace(_shortened(verdict), quality=prepared.flaws, basis=basis)
    return _held_against(_concluded(verdict, machine, offered), left_out, chosen.rate)


def _held_against(found: Diagnosis, held_out: Sequence[Recording], rate: float) -> Diagnosis:
    """With what it is worth elsewhere: as an MJCF file, and in motion where efforts told it."""
    if found.extended is None:
        return found
    pair = found.machine, found.extended, held_out, rate
    simulated = Simulated.of(*pair) if found.verdict.basis.by_motion else None
    return replace(found, carried=Carried.of(*pair), simulated=simulated)


def _named(
    recordings: Sequence[Recording | Named],
    held_out: Sequence[Recording | Named],
    baseline: Sequence[Recording | Named],
    commissioning: Sequence[Recording | Named],
    standstill: Recording | None,
) -> Material:
    return Material(
        named(recordings, "recording"),
        named(held_out, "held-out recording"),
        named(baseline, "baseline recording"),
        named(commissioning, "commissioning recording"),
        standstill,
    )


def _shortened(verdict: Verdict) -> Verdict:
    """With the magnitudes of effects as the names of their parameters."""
    causes = tuple(cause.shortened for cause in verdict.causes)
    return replace(verdict, causes=causes, nearest=tuple(c.shortened for c in verdict.nearest))


def _check_held_out(given: Material) -> None:
    """Refuse a held-out recording that is fitted as well: it would confirm anything."""
    for held in given.held_out:
        for one in given.measured:
            if _same(held.recording, one.recording):
                expected = f"another one than {one.name}, which is fitted and has the same rows"
                raise InvalidInputError("held-out recording", held.name, expected)


def _same(one: Recording, other: Recording) -> bool:
    """Whether two recordings have the same signals and rows."""
    if one.signals.keys() != other.signals.keys() or not np.array_equal(one.time, other.time):
        return False
    pairs = ((values, other.signals[name]) for name, values in one.signals.items())
    return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)


def _origin(given: Material) -> str:
    """Whether all that was fitted and held out comes from logs: what simulates writes no log."""
    told = (*given.measured, *given.held_out)
    return "external" if all(one.recording.info.imported for one in told) else "unknown"


def _concluded(verdict: Verdict, machine: Machine, offered: Sequence[Excitation]) -> Diagnosis:
    """With the extended machine where causes are named, else with what comes nearest."""
    if verdict.verdict.names_a_plant:
        new = machine.extended(verdict)
        return Diagnosis(verdict, machine, new, machine.refusal(verdict))
    if verdict.law is not None and verdict.law.claimed:
        return Diagnosis(verdict, machine, machine.extended(verdict), verdict.law.refusal)
    best = verdict.next_experiment[0].programme if verdict.next_experiment else ""
    chosen = next((one for one in offered if one.name == best), None)
    why = f"the verdict is {verdict.verdict.value}"
    near = verdict.nearest
    nearest = machine.extended(replace(verdict, causes=near)) if near else None
    return Diagnosis(verdict, machine, None, why, chosen, nearest)


def prepare(
    machine: Machine, material: Material, experiment: ExperimentFile | None = None
) -> Prepared:
    """`Machine.prepare` of at least one recording.

    Raises:
        InvalidInputError: no recording.
    """
    if not material.measured:
        raise InvalidInputError("recordings", "none", "at least one")
    return machine.prepare(material, experiment)


def settings_of(machine: Machine, settings: Settings | None, recording: Recording) -> Settings:
    """Settings as the machine has them for a recording."""
    fed = Excitation.of(recording, machine.forward.drive)
    return machine.settings(settings or Settings(), fed)


def verdict_on(
    recordings: Sequence[Recording | Named], plant: Given = None, **material: Any
) -> Verdict:
    """The verdict of `diagnose` alone, as `ves_twin.diagnose`; the same arguments.

    An extended plant of VES II is `plant.extended(*effects_of(verdict))`.
    """
    return diagnose(recordings, plant, **material).verdict
