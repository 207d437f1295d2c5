"""design: an excitation that tells causes of a machine apart, within its limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.experiment.design import Design, design_excitation
from ves_twin.diagnosis.experiment.plan import check_channels, columns_of, plan_recording
from ves_twin.diagnosis.experiment.separation import Question
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.runs import Progress, silent
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.load import Given, machine_of
from ves_twin.machines.machine import Machine

CAUSES = "causes"
"""Asks for all causes that the machine's first excitation confuses."""

MOST = 12
"""Pairs of them, those first that are told apart at no size."""

SECONDS = 5.0
"""Length of a design [s]: half that of a menu's multisines."""


@dataclass(frozen=True)
class Designed:
    """A design, and the machine that carries it out."""

    machine: Machine
    design: Design


def design(
    plant: Given = None,
    causes: str = CAUSES,
    excitation: str = "",
    *,
    channels: Sequence[str] = (),
    seconds: float | None = None,
    settings: Settings | None = None,
    progress: Progress = silent,
) -> Designed:
    """Optimise an excitation of a machine for telling causes apart, within its limits.

    Args:
        plant: the machine, or its name or file; VES II as its first scenario has it if left out.
        causes: "A/B", each a kind or kind@target, as a plan prints them, too; or CAUSES.
        excitation: a scenario of VES II, whose rates are kept, or what the machine offers, which
            CAUSES goes by; the machine's first choice if empty.
        channels: signals or columns that would be recorded; all if none are given.
        seconds: length [s]; SECONDS if left out.
        settings: how sure, how many processes; the machine may set what its size asks.
        progress: told what is being done.

    Raises:
        VesTwinError: causes or channels that do not exist, or a machine whose inputs have no
            known limits.
    """
    progress(0.0, "inputs")
    machine, fed = machine_of(plant).excitation(excitation)
    forward = machine.forward
    check_channels(forward, channels)
    length = SECONDS if seconds is None else seconds
    space = machine.design_space(length)
    chosen = machine.settings(settings or Settings(), fed)
    question = _question(machine, causes, fed, channels, chosen, progress)
    found = design_excitation(
        forward,
        question,
        machine.excitations(),
        space,
        columns=columns_of(forward, channels),
        settings=chosen,
        progress=progress,
    )
    return Designed(machine, found)


def _question(
    machine: Machine,
    causes: str,
    fed: Excitation,
    channels: Sequence[str],
    settings: Settings,
    progress: Progress,
) -> Question:
    forward = machine.forward
    if causes != CAUSES:
        names = [_label(name) for name in causes.split("/")]
        if len(names) < 2 or not all(names):
            raise InvalidInputError("causes to tell apart", causes, f"A/B, or {CAUSES}")
        return Question.of(forward, machine.causes(names))
    plan = plan_recording(
        forward, fed, channels=channels, quick=True, settings=settings, progress=progress
    )
    pairs = sorted(plan.lookalikes, key=lambda pair: pair.beyond is not None)
    labels = {cause.label: cause for cause in forward.hypotheses}
    chosen = {frozenset((pair.cause, pair.other)): pair for pair in pairs}
    if not chosen:
        expected = f"causes that {plan.programme} confuses: it confuses none; or A/B"
        raise InvalidInputError("causes to tell apart", causes, expected)
    first = list(chosen.values())[:MOST]
    return Question.of_pairs([(labels[p.cause], labels[p.other]) for p in first], causes)


def _label(spoken: str) -> str:
    """A cause as the library has it, of "actuator delay at drive", "leg 3" being "leg.3"."""
    effect, _, target = spoken.strip().replace(" at ", "@").partition("@")
    kind = effect.strip().lower().replace(" ", "_")
    return f"{kind}@{target.strip().replace(' ', '.')}" if target else kind
