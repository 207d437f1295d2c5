"""diagnose_rig: recordings of VES II to a verdict and, where it names causes, an extended plant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.forward import Excitation
from ves_twin.diagnosis.refusal import refusal
from ves_twin.diagnosis.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Cause, Verdict
from ves_twin.effects.effect import Effect
from ves_twin.effects.registry import build_effect
from ves_twin.machines.ves2.declared_load import LOAD
from ves_twin.machines.ves2.excitations import offered_programmes
from ves_twin.machines.ves2.filter_place import EFFECT as FILTER_PLACE
from ves_twin.machines.ves2.filter_place import WithFilterPlaces
from ves_twin.machines.ves2.forward import RigForward
from ves_twin.machines.ves2.inputs import prepare_inputs
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.replay import replay_scenario


@dataclass(frozen=True)
class RigDiagnosis:
    """What was found, and the plant that has it.

    Attributes:
        verdict: with the magnitudes of the effects as the names of its parameters.
        extended: the nominal plant with the causes; None where no causes are named.
        refused: why the extension is only a candidate; empty where it passed on held-out data.
        next_programme: set-points that should part the causes, where they cannot be told apart.
        scenario: rates, leg gains and belief that the recordings were taken to be made with.
    """

    verdict: Verdict
    extended: Plant | None
    refused: str
    next_programme: Excitation | None = None
    scenario: Scenario | None = None


def diagnose_rig(
    recordings: Sequence[Recording],
    plant: Plant,
    *,
    held_out: Sequence[Recording] = (),
    commissioning: Sequence[Recording] = (),
    standstill: Recording | None = None,
    baseline: Sequence[Recording] = (),
    exclude: Sequence[str] = (),
    scenario: Scenario | None = None,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> RigDiagnosis:
    """Name what the simulation of VES II gets wrong in recordings of one rig.

    Args:
        recordings: what was measured; together one record.
        plant: the nominal rig, with the tolerances that commissioning left.
        held_out: other recordings of the same rig, on which an extension must prove itself.
        commissioning: recordings of healthy rigs, or of this one mounted anew.
        standstill: the rig standing still, which tells the noise. Legs that hunt over a count
            while they stand make more of it than in motion; then the declared noise is better.
        baseline: of this rig in order, with the same set-points; see `diagnose`.
        exclude: causes that are not considered, by kind or kind@target.
        scenario: rates and leg gains; that of the first recording if left out.
        settings: how sure, how many, where banks are kept.
        progress: told what is being done.

    Raises:
        VesTwinError: recordings whose columns look swapped, turned or in other units.
        InvalidInputError: no recording, or recordings made with other rates or leg settings.
        UnknownNameError: an unknown cause in `exclude`, or a set-point that is not recorded.
    """
    if not recordings:
        raise InvalidInputError("recordings", "none", "at least one")
    measured = prepare_inputs(recordings, plant, "recording")
    others = prepare_inputs(held_out, plant, "held-out recording")
    rigs = prepare_inputs(commissioning, plant, "commissioning recording")
    usual = prepare_inputs(baseline, plant, "baseline recording")
    setting = one_step(replay_scenario(measured.recordings[0], scenario))
    if scenario is None:
        every = (*measured.recordings, *others.recordings, *rigs.recordings, *usual.recordings)
        _check_settings(every, setting)
    sorts = (measured, others, rigs, usual)
    loaded = any(LOAD.name in r.signals for sort in sorts for r in sort.recordings)
    if loaded:
        measured, others, rigs, usual = (s.with_loads() for s in sorts)
    forward = WithFilterPlaces(RigForward(plant, setting, loaded=loaded))
    offered: list[Excitation] = []

    def menu() -> list[Excitation]:
        offered.extend(offered_programmes(plant, setting))
        return offered

    verdict = diagnose(
        forward,
        measured.recordings,
        held_out=others.recordings,
        commissioning=rigs.recordings,
        standstill=standstill,
        baseline=usual.recordings,
        next_programmes=menu,
        exclude=exclude,
        settings=drawn_nulls(settings),
        progress=progress,
    )
    flaws = (*measured.flaws, *others.flaws, *rigs.flaws, *usual.flaws)
    verdict = replace(verdict, causes=tuple(c.shortened for c in verdict.causes), quality=flaws)
    if not verdict.verdict.names_a_plant:
        best = verdict.next_experiment[0].programme if verdict.next_experiment else ""
        chosen = next((p for p in offered if p.name == best), None)
        why = f"the verdict is {verdict.verdict.value}"
        return RigDiagnosis(verdict, None, why, chosen, setting)
    effects = effects_of(verdict)
    extended = plant.extended(*effects) if effects else None
    return RigDiagnosis(verdict, extended, _refused(verdict), scenario=setting)


def drawn_nulls(settings: Settings | None) -> Settings:
    """Null rigs from the linearisation: fitting one of this many parameters takes 300 runs."""
    return replace(settings or Settings(), simulated_nulls=False)


def verdict_on(recordings: Sequence[Recording], plant: Plant, **material: Any) -> Verdict:
    """The verdict of `diagnose_rig` alone, as `ves_twin.diagnose`; the same arguments.

    An extended plant is `plant.extended(*effects_of(verdict))`.
    """
    return diagnose_rig(recordings, plant, **material).verdict


def effects_of(verdict: Verdict) -> tuple[Effect, ...]:
    """The effects that a verdict names, at their estimated sizes; none where it names none.

    A filter at another place is no part of a plant: that is the scenario's `legs.filter`.
    """
    if not verdict.verdict.names_a_plant:
        return ()
    return tuple(effect_of(c) for c in verdict.causes if c.effect != FILTER_PLACE)


def effect_of(cause: Cause) -> Effect:
    """The effect that a cause names, at its estimated size."""
    sizes = {name: estimate.value for name, estimate in cause.parameters.items()}
    return build_effect(cause.effect, cause.target, sizes)


def _refused(verdict: Verdict) -> str:
    places = [cause.target for cause in verdict.causes if cause.effect == FILTER_PLACE]
    if places:
        return f'no plant has the leg program: run scenarios with legs.filter = "{places[0]}"'
    return refusal(verdict)


def one_step(scenario: Scenario) -> Scenario:
    """A scenario with the model's own step, whatever a recording was made with."""
    return scenario.model_copy(update={"run": scenario.run.model_copy(update={"substeps": 1})})


def _check_settings(recordings: Sequence[Recording], first: Scenario) -> None:
    for number, recording in enumerate(recordings, 1):
        other = replay_scenario(recording)
        for what, here, there in (
            ("platform.rate", other.platform.rate, first.platform.rate),
            ("legs", other.legs, first.legs),
        ):
            if here != there:
                where = f"recording {number}: {what}"
                raise InvalidInputError(where, here, f"{there}, as in the first one")
