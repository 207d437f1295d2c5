"""Laws of a plant's file that are causes: as parameters, as hypotheses, at work, and named."""

from __future__ import annotations

from collections.abc import Mapping

from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.effects.law import Law
from ves_twin.effects.law_table import CAUSE, FACTORS, LawTable
from ves_twin.plant.plant import Plant


def law_causes(plant: Plant) -> tuple[LawTable, ...]:
    """Those of the file that do not act, and may be named."""
    return tuple(told for told in plant.told_laws if told.cause)


def law_parameters(plant: Plant) -> tuple[Parameter, ...]:
    """A factor on each."""
    most = FACTORS[1]
    return tuple(Parameter(law.name, "1", 0.0, -most, most) for law in law_causes(plant))


def law_hypotheses(plant: Plant) -> tuple[Hypothesis, ...]:
    """Each as a cause."""
    least, most = FACTORS
    return tuple(
        Hypothesis(
            CAUSE, law.law.label, (law.name,), (least,), (most,), source=law.source,
            transient="time" in law.of,
        )
        for law in law_causes(plant)
    )  # fmt: skip


def scaled_laws(plant: Plant, values: Mapping[str, float]) -> list[Law]:
    """Those that are at work where parameters have values."""
    return [
        law.scaled(values[law.name]).law
        for law in law_causes(plant)
        if values.get(law.name, 0.0) != 0.0
    ]


def named_laws(plant: Plant, verdict: Verdict) -> list[LawTable]:
    """Those that a verdict names, at work."""
    factors = {c.target: e.value for c in verdict.causes for e in c.parameters.values()}
    own = law_causes(plant) if verdict.verdict.names_a_plant else ()
    return [law.scaled(factors[law.law.label]) for law in own if law.law.label in factors]
