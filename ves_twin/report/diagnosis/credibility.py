"""credibility: what of a verdict is verified, validated or assumed, factor by factor.

Source: NASA-STD-7009 (2008), the eight factors of its credibility assessment scale.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from ves_twin.core.quantity import digits
from ves_twin.diagnosis.explain.rivals import Standing
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.report.diagnosis.basis import gain_words


class Pedigree(StrEnum):
    """How a factor stands."""

    VALIDATED = "validated"
    VERIFIED = "verified"
    MEASURED = "measured"
    ASSUMED = "assumed"
    OPEN = "not shown"


@dataclass(frozen=True)
class Factor:
    """One factor: its name, how it stands, and on what."""

    name: str
    standing: Pedigree
    said: str


def credibility(verdict: Verdict) -> tuple[Factor, ...]:
    """The eight factors of a verdict."""
    return (
        Factor(
            "verification",
            Pedigree.VERIFIED,
            "The code is tested against closed forms and other programs; the error of the"
            " integration step is estimated for these recordings and allowed for.",
        ),
        _validation(verdict),
        _input(verdict),
        _uncertainty(verdict),
        _robustness(verdict),
        Factor(
            "use history",
            Pedigree.MEASURED,
            "Faults hidden in simulated recordings, answered blind; the scorecard of the project"
            " counts them. Public recordings of a few other machines.",
        ),
        Factor(
            "management",
            Pedigree.VERIFIED,
            "Versions and hashes stand in recordings and plants; a run repeats to the last bit.",
        ),
        Factor("people", Pedigree.OPEN, "Who measured, and who reads this, is not known."),
    )


def _validation(verdict: Verdict) -> Factor:
    """Validated only where external recordings that were held out are predicted better."""
    basis, gain = verdict.basis, verdict.gain
    named = verdict.verdict.names_a_plant
    passed = gain is not None and gain.passed and not verdict.unconfirmed
    external = basis.recordings == "external"
    if external and basis.held_out != "none" and named and passed and gain is not None:
        said = (
            f"External recordings were held out; gain of the extended model: {gain_words(verdict)}."
            " Beyond motions like those nothing is shown."
        )
        return Factor("validation", Pedigree.VALIDATED, said)
    why = []
    if not external:
        why.append("the recordings do not come from a log of a machine")
    if basis.held_out == "none":
        why.append("no recording was held out")
    elif not passed:
        why.append("held-out recordings show no clear gain")
    if not named:
        why.append("no cause is named, so there is no extended model")
    return Factor("validation", Pedigree.OPEN, f"Not shown: {'; '.join(why)}.")


def _input(verdict: Verdict) -> Factor:
    failed = list(dict.fromkeys(check.name for check in verdict.quality))
    if failed:
        said = f"Checks of the recordings that did not pass: {', '.join(failed)}."
        return Factor("input pedigree", Pedigree.OPEN, said)
    lost = ", ".join(verdict.unseen)
    said = "No check of the recordings failed." + (f" Not recorded: {lost}." if lost else "")
    return Factor("input pedigree", Pedigree.MEASURED, said)


def _uncertainty(verdict: Verdict) -> Factor:
    basis = verdict.basis
    declared = basis.noise != "measured" or basis.tolerances != "measured"
    standing = Pedigree.ASSUMED if declared else Pedigree.MEASURED
    said = (
        f"Noise: {basis.noise}; tolerances: {basis.tolerances}. Intervals are 90 % if the model is"
        " otherwise right."
    )
    return Factor("results uncertainty", standing, said)


def _robustness(verdict: Verdict) -> Factor:
    fitted = [r for r in verdict.rivals if r.standing is not Standing.SCREENED]
    others = [r for r in fitted if r.causes != fitted[0].causes]
    if others and others[0].behind is not None:
        said = (
            f"Explanations fitted in full: {len(fitted)}. The nearest rival of the best leaves"
            f" {digits(others[0].behind)} more of chi^2."
        )
        return Factor("results robustness", Pedigree.MEASURED, said)
    said = f"Causes searched: {len(verdict.smallest_findable)}; none had to be fitted."
    return Factor("results robustness", Pedigree.MEASURED, said)
