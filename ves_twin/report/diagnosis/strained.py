"""Which of the model's own numbers left their tolerances, in sentences."""

from __future__ import annotations

from ves_twin.core.quantity import quantity
from ves_twin.diagnosis.explain.rivals import Standing
from ves_twin.diagnosis.verdict.cause import Estimate
from ves_twin.diagnosis.verdict.verdict import Kind, Verdict
from ves_twin.report.diagnosis.words import TOLD, interval_words, spoken

STRANGEST = 2
"""Numbers of the model that are told where tolerances do not hold: what moved by most."""


SHOWN_FROM = 2.0
"""Declared sd from which a tuned number is told: one of twenty in order is as far off."""

STRAINED = 3.0
"""Declared sd beyond which a commissioning error is called strained."""


def moved(verdict: Verdict) -> list[tuple[str, Estimate]]:
    """The model's own numbers that the fit moved: those held at a limit first, then the surest."""

    def order(item: tuple[str, Estimate]) -> tuple[bool, float]:
        one = item[1]
        return not one.at_limit, -abs(one.value - one.nominal) / max(one.high - one.low, 1e-30)

    return sorted(verdict.tuned.items(), key=order)


def tuned_words(verdict: Verdict) -> str:
    """The model's own numbers that moved by SHOWN_FROM declared sd, by that.

    Beside causes, or where none explains the record: what they stand for is then open.
    """
    unknown = verdict.verdict is Kind.UNKNOWN and verdict.statistics.misfit_in_order is None
    shown = bool(verdict.causes) or unknown
    told = [
        f"{spoken(name.rpartition(':')[0])} {interval_words(one)}, {pull:.1f} declared tolerances"
        f" from the model's {quantity(one.nominal, one.unit)}"
        for pull, name, one in (_far(verdict, SHOWN_FROM) if shown else [])
    ]
    named = _named(verdict)
    told += [
        f"{spoken(name.rpartition(':')[0])} {_beside_law(one, named[name].nominal)}"
        for name, one in verdict.tuned.items()
        if name in named
    ]
    more = f"; and {len(told) - TOLD} more (verdict.json)" if len(told) > TOLD else ""
    return "; ".join(told[:TOLD]) + more


def _beside_law(one: Estimate, model: float) -> str:
    """Size of a cause where the law is at work, and what the model has where it may be that."""
    words = f"{interval_words(one)} beside the law"
    may_be = one.low <= model <= one.high
    return f"{words}, not clear of the model's {quantity(model, one.unit)}" if may_be else words


def _named(verdict: Verdict) -> dict[str, Estimate]:
    """Sizes of named causes, as they were found without a law; they are fitted anew beside one."""
    return {
        f"{cause.effect}@{cause.target}:{name}": size
        for cause in verdict.causes
        for name, size in cause.parameters.items()
    }


def check_sentence(verdict: Verdict) -> str:
    """What to measure: numbers that data put beyond STRAINED declared sd; empty where none is."""
    far = _far(verdict, STRAINED)
    if not far:
        return ""
    more = f" and {len(far) - STRANGEST} more" if len(far) > STRANGEST else ""
    each = "; ".join(f"{_told(name, one)}" for _, name, one in far[:STRANGEST])
    return (
        f"Measure what the data put more than {STRAINED:.0f} declared tolerances off: {each}{more}."
    )


def _far(verdict: Verdict, sd: float) -> list[tuple[float, str, Estimate]]:
    """Numbers whose interval is away from the model's by more than so many declared sd."""
    far = [
        (abs(one.pull), name, one)
        for name, one in verdict.tuned.items()
        if one.pull is not None and abs(one.pull) > sd
        if name not in _named(verdict)
        if not (one.at_limit or one.low <= one.nominal <= one.high)
    ]
    return sorted(far, key=lambda item: -item[0])


def held(verdict: Verdict) -> list[str]:
    """The model's own numbers that their limit holds, each as "friction at hub 4 N (model 3 N)"."""
    return [_told(name, one) for name, one in moved(verdict) if one.at_limit]


def strained_sentence(verdict: Verdict) -> str:
    """Which numbers a limit holds, or had to leave their tolerances; else empty."""
    at_limit = held(verdict)
    if at_limit:
        more = f" and {len(at_limit) - TOLD} more" if len(at_limit) > TOLD else ""
        each = "it stands" if len(at_limit) == 1 else "each stands"
        return (
            f" At the limit of its tolerance, so that {each} for something else or is declared too"
            f" narrowly: {', '.join(at_limit[:TOLD])}{more}."
        )
    best = next((rival for rival in verdict.rivals if rival.standing is Standing.KEPT), None)
    limit = verdict.statistics.naming_limit
    if best is None or best.pull is None or limit is None or best.pull <= limit:
        return ""
    listed = moved(verdict)[:STRANGEST]
    pulls = [abs(one.pull) for _, one in listed if one.pull is not None]
    most = max(pulls, default=best.pull)
    told = [_told(name, one) for name, one in listed]
    return f" Tolerances are strained, by up to {most:.0f} sd: {', '.join(told)}."


def moved_words(one: Estimate) -> str:
    """How well a number that the fit moved is known."""
    return "held at its limit" if one.at_limit else interval_words(one)


def _told(name: str, one: Estimate) -> str:
    value, model = quantity(one.value, one.unit), quantity(one.nominal, one.unit)
    far, way = one.value - one.nominal, "more" if one.value > one.nominal else "less"
    off = f", {quantity(abs(far), one.unit)} {way}" if value == model else ""
    return f"{spoken(name.rpartition(':')[0])} {value} (model {model}{off})"
