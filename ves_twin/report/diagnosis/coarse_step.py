"""coarse_sentence, finer: a model's step that puts its prediction off by what matters here."""

from __future__ import annotations

from ves_twin.core.quantity import digits, quantity
from ves_twin.diagnosis.verdict.verdict import Verdict

COARSE = 0.5
"""Error of the step, of what is left of a channel, from which it is told: below, it adds an eighth
to what is left at most."""

SPOILS = 3.0
"""The same, from which a finer step is the first thing to do: what else is left is smaller."""

SMALLER = 4
"""Times smaller that a step is to be: the fit allows for its error in a straight line, and what
bends falls as the square of the step."""


def coarse(verdict: Verdict) -> dict[str, float]:
    """Channel -> error of the step over what is left of it, where that matters; the worst first."""
    ratios = {
        name: error.step_si / error.after_si
        for name, error in verdict.residuals.items()
        if error.step_si > COARSE * error.after_si > 0.0
    }
    return dict(sorted(ratios.items(), key=lambda item: -item[1]))


def coarse_sentence(verdict: Verdict) -> str:
    """That the step is coarse, by how much, and what it spoils; empty where it is not."""
    found = coarse(verdict)
    if not found:
        return ""
    name, ratio = next(iter(found.items()))
    error = verdict.residuals[name]
    return (
        f"Step: the model's step puts {name} {quantity(error.step_si, error.unit)} off (rms),"
        f" {digits(ratio)} times what is left of it. The fit allows for that in a straight line:"
        " sizes may be off by more than their intervals, and a simulation of the model does worse"
        " than the fit."
    )


def finer(verdict: Verdict) -> str:
    """Which step to take; empty where something else is to be done first."""
    if max(coarse(verdict).values(), default=0.0) < SPOILS:
        return ""
    return f"Take a step {SMALLER} times smaller (timestep in the model's file) and diagnose again."
