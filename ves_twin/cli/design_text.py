"""design_text: a designed excitation beside the menu's best, for the terminal."""

from __future__ import annotations

from ves_twin.core.quantity import quantity
from ves_twin.diagnosis.experiment.design import Design, Judged
from ves_twin.report.diagnosis.words import spoken


def design_text(design: Design) -> str:
    """What the menu's best tells of each pair of causes, and what the design does."""
    best, designed = design.best, design.designed
    return "\n".join(
        [
            f"design    {designed.programme}, {designed.seconds:.1f} s; the best of {design.tried}"
            " that were tried, within the machine's limits",
            f"menu      {best.programme}, {best.seconds:.1f} s; the best of it for this question",
            "rests on  the declared noise, the declared tolerances, and the nominal machine",
            "",
            *(line for k in range(len(design.question.pairs)) for line in _pair(design, k)),
            "",
            _sentence(design),
        ]
    )


def _pair(design: Design, number: int) -> list[str]:
    causes = design.question.causes
    i, j = design.question.pairs[number]
    best, designed = design.best, design.designed
    rows = [("", "menu", "designed"), ("separation", *_sigmas(best, designed, number))]
    for side, own in enumerate((i, j)):
        unit = design.units[own]
        told = [judged.told[number][side] for judged in (best, designed)]
        words = [f"from {quantity(size, unit)} on" if size else "at no size" for size in told]
        rows.append((f"{spoken(causes[own].label)} told from the other", words[0], words[1]))
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    lines = ["  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in rows]
    head = f"{spoken(causes[i].label)} / {spoken(causes[j].label)}"
    return [head, *(f"  {line.rstrip()}" for line in lines)]


def _sigmas(best: Judged, designed: Judged, number: int) -> tuple[str, str]:
    return f"{best.sigma[number]:.2g} sigma", f"{designed.sigma[number]:.2g} sigma"


def _sentence(design: Design) -> str:
    best, seconds = design.best.seconds, design.designed.seconds
    if design.after is not None:
        return (
            f"The design tells as much after {design.after:.2g} s as the menu's best in"
            f" {best:.2g} s."
        )
    if design.times > 1.0 and seconds < best:
        return (
            f"In {seconds:.2g} s the design tells {design.times:.2g} times as much (chi^2) as the"
            f" menu's best in the same time; in {best:.2g} s that tells more."
        )
    return "The menu's best tells more than this design: take that, or a longer --seconds."
