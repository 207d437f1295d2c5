"""diagnosis_page: a verdict as one HTML page: what is wrong, how sure, and why nothing else."""

from __future__ import annotations

from collections.abc import Sequence

from ves_twin.core.quantity import UNSURE, digits, quantity
from ves_twin.data.quality.check import Check
from ves_twin.diagnosis.explain.rivals import Rival
from ves_twin.diagnosis.verdict.cause import MANY, Cause
from ves_twin.diagnosis.verdict.report_traces import ReportTraces
from ves_twin.diagnosis.verdict.verdict import Kind, Verdict
from ves_twin.report.diagnosis.answer import (
    confidence_sentence,
    nearest_sentence,
    next_step,
    tone,
    verdict_sentence,
    why_loose,
)
from ves_twin.report.diagnosis.basis import basis_sentences, gain_sentence, rests_on
from ves_twin.report.diagnosis.credibility import credibility
from ves_twin.report.diagnosis.flaws import RESTS, flaws
from ves_twin.report.diagnosis.law import law_heading, law_parts
from ves_twin.report.diagnosis.limits import (
    blind_causes,
    findable_sentence,
    limit_sentences,
    next_sentences,
    rival_words,
)
from ves_twin.report.diagnosis.pictures import (
    answer_figure,
    cells_figure,
    change_figure,
    residuals_figure,
    trace_figure,
)
from ves_twin.report.diagnosis.proved import ended, proved_parts
from ves_twin.report.diagnosis.strained import moved, moved_words
from ves_twin.report.diagnosis.words import (
    alone_sentences,
    ambiguity_sentences,
    capital,
    ends_words,
    fitted_word,
    interval_words,
    listed,
    name_of,
    size_words,
    spoken,
)
from ves_twin.report.html import (
    Html,
    bullets,
    folded,
    joined,
    markup,
    paragraph,
    section,
    table,
)
from ves_twin.report.page import html_page

SHOWN = 4
"""Channels drawn large: those that the cause changes most beyond what tolerances can."""

CHI2 = (
    "chi^2 is the squared error in units of noise, summed over the recordings, and that of each"
    " tolerance in units of its sd. A rival that is worse by about 10 or more is unlikely; one that"
    " is worse by 2 is as good. Sizes are changes of what the model has, of each explanation by"
    " itself."
)
"""How the table of rivals is read; 2 ln 100, at which a rival is dropped, is 9.2."""

DRAWN = 2
"""Recordings whose traces are drawn; the numbers are of all."""


def diagnosis_page(verdict: Verdict, title: str = "Diagnosis", plant: str = "") -> str:
    """The page of a verdict that still has its traces.

    Args:
        verdict: from `diagnose`; one read from a file has no traces, and gets no pictures.
        title: heading, for instance the recordings' names.
        plant: what became of the extended plant, one sentence.
    """
    exhibit = verdict.exhibit
    parts = [
        _answer(verdict, plant),
        section("The answer in figures", *_figures(verdict)),
        section("Before and after", *_levels(verdict)),
    ]
    if exhibit:
        parts += _pictures(verdict, exhibit)
    parts += proved_parts(verdict)
    if verdict.law is not None:
        law = law_parts(verdict.law, ended(verdict))
        parts.insert(1, section(law_heading(verdict.law), *law))
    if verdict.rivals:
        note = paragraph(CHI2, "note")
        parts.append(section("Rivals, and why they lost", note, _rivals(verdict.rivals)))
    parts += [
        section("Smallest size that would have been found", *_findable(verdict)),
        section("What this does not prove", bullets(limit_sentences(verdict))),
    ]
    if verdict.leftover:
        parts.append(section("What is left", *_leftover(verdict)))
    parts.append(section("Next experiment", *_next(verdict)))
    parts.append(section("How credible this is", *_credibility(verdict)))
    return html_page(title, parts)


def _answer(verdict: Verdict, plant: str) -> Html:
    """The first screen: verdict, how sure, what next, one picture."""
    parts = [
        paragraph(verdict_sentence(verdict), f"lead {tone(verdict)}"),
        _said("How sure", confidence_sentence(verdict)),
        _said("What next", next_step(verdict)),
    ]
    if verdict.exhibit:
        parts.append(answer_figure(verdict.exhibit, fitted_word(verdict)))
    parts += [_said("Rests on", capital(rests_on(verdict.basis)))]
    parts += _flaws(verdict.quality)
    if plant:
        parts.append(paragraph(plant, "note"))
    return joined(parts)


def _flaws(checks: Sequence[Check]) -> list[Html]:
    """Checks that failed, the first of each sort; the others unfold."""
    first, more = flaws(checks)
    parts = []
    if first:
        parts.append(paragraph(RESTS, "bad"))
        parts.append(bullets(first))
    if more:
        parts.append(folded(f"{len(more)} more like these", bullets(more)))
    return parts


def _said(what: str, text: str) -> Html:
    return paragraph(Html(f"<b>{markup(what)}.</b> {markup(text)}"))


def _figures(verdict: Verdict) -> list[Html]:
    """What stands behind the first screen: sizes, gain, rivals that cannot be told apart, basis."""
    parts = []
    if verdict.causes and not verdict.proved:
        head = ("cause", "size", "90 % interval", _origin(verdict), "probability", "standing")
        parts.append(table(head, [row for c in verdict.causes for row in _cause(c, verdict)]))
        parts += [
            paragraph(
                f"The largest {len(c.largest)} of {len(c.parameters)} numbers of {name_of(c)};"
                " verdict.json has all.",
                "note",
            )
            for c in verdict.causes
            if len(c.largest) < len(c.parameters)
        ]
    for said in (nearest_sentence(verdict), gain_sentence(verdict)):
        if said:
            parts.append(paragraph(said))
    parts.append(bullets(ambiguity_sentences(verdict)))
    parts.append(bullets(alone_sentences(verdict)))
    parts.append(bullets(basis_sentences(verdict)))
    return parts


def _origin(verdict: Verdict) -> str:
    """What departures count from."""
    return "the baseline" if verdict.basis.baseline == "measured" else "nominal"


def _cause(cause: Cause, verdict: Verdict) -> list[tuple[str, ...]]:
    why = "not confirmed on held-out recordings" if verdict.unconfirmed else why_loose(cause)
    standing = "firm" if cause.firm else f"provisional, {why}"
    if verdict.verdict is Kind.AMBIGUOUS:
        standing = f"one of {len(verdict.alternatives)}, {standing}"
    return [
        (
            name_of(cause) if len(cause.parameters) == 1 else f"{name_of(cause)}: {name}",
            size_words(estimate, _origin(verdict)),
            interval_words(estimate),
            quantity(estimate.nominal, estimate.unit),
            _probability(cause.probability),
            standing,
        )
        for name, estimate in cause.largest.items()
    ]


def _probability(share: float) -> str:
    """Never certain: what is not in the library has no share."""
    return "> 99 %" if share > 0.99 else f"{100.0 * share:.0f} %"


def _levels(verdict: Verdict) -> list[Html]:
    head: tuple[str, ...] = ("channel", "before, sigma", "after, sigma")
    head += ("before", "tolerances alone", "after")
    spreads = any(e.spread for e in verdict.residuals.values())  # what a motion lacks has none
    head += ("spread of the signal",) * spreads
    rows = [
        (
            name,
            digits(e.before),
            digits(e.after),
            quantity(e.before_si, e.unit),
            quantity(e.after_si if e.tolerances_si is None else e.tolerances_si, e.unit),
            quantity(e.after_si, e.unit),
            *(quantity(e.spread, e.unit),) * spreads,
        )
        for name, e in verdict.residuals.items()
    ]
    return [change_figure(verdict), table(head, rows), *_moved(verdict)]


def _moved(verdict: Verdict) -> list[Html]:
    """The model's own numbers that were fitted beside: a fault may hide in a wide tolerance."""
    away = [
        (name, one)
        for name, one in moved(verdict)
        if one.at_limit or not one.low <= one.nominal <= one.high
    ]
    if not away:
        return []
    rows = [
        (
            spoken(name.rpartition(":")[0]) + (f", {name.rpartition(':')[2]}"),
            quantity(one.nominal, one.unit),
            quantity(one.value, one.unit),
            moved_words(one),
        )
        for name, one in away
    ]
    said = (
        "Numbers of the model that were fitted beside, as their tolerances let them move. What a"
        " wide tolerance lets move is not called a fault. What is held at its limit stands for"
        " something else, or its tolerance is declared too narrowly."
    )
    shown = table(("number", "model", "fitted", "interval"), rows)
    if len(rows) > 2 * SHOWN:
        shown = folded(f"{len(rows)} numbers that moved", shown)
    return [paragraph(said, "note"), shown]


def _pictures(verdict: Verdict, exhibit: ReportTraces) -> list[Html]:
    large = exhibit.telling[:SHOWN].tolist()
    shown = exhibit.traces[:DRAWN]
    what = (
        f"The model with {listed(list(map(spoken, exhibit.causes)))}, beside the best that its"
        " tolerances alone can do, in the channels where the two differ most."
        if exhibit.causes
        else "No cause is in the model: its tolerances alone are fitted."
    )
    if verdict.verdict is Kind.UNKNOWN and exhibit.causes and not verdict.lawful:
        what += " That cause is the nearest that the library has, and was not accepted."
    left = [
        residuals_figure(exhibit.channels, traces, f"r{k}") for k, traces in enumerate(shown, 1)
    ]
    return [
        section(
            "Measured, without and with the cause",
            paragraph(what, "note"),
            *(
                trace_figure(exhibit, t, c, fitted_word(verdict), f"r{k}")
                for k, t in enumerate(shown, 1)
                for c in large
            ),
            folded("What is left in every channel", *left),
        ),
        section(
            "Where it was, and what is left",
            folded(
                "Before",
                cells_figure(exhibit, exhibit.before, "band", "before"),
                cells_figure(exhibit, exhibit.before, "time", "before"),
            ),
            cells_figure(exhibit, exhibit.after, "band", "after"),
            cells_figure(exhibit, exhibit.after, "time", "after"),
        ),
    ]


def _rivals(rivals: tuple[Rival, ...]) -> Html:
    head = ("cause", "change of the model", "worse than the best by (chi^2)", "why")
    rows = [
        (
            " with ".join(map(spoken, rival.causes)),
            _sizes(rival),
            _chi2(rival.behind),
            rival_words(rival, best=n == 0),
        )
        for n, rival in enumerate(rivals)
    ]
    return table(head, rows)


def _sizes(rival: Rival) -> str:
    if len(rival.sizes) > MANY:
        size, unit = max(rival.sizes, key=lambda one: abs(one[0]))
        return f"{len(rival.sizes)} numbers, up to {quantity(size, unit)}"
    return ", ".join(quantity(size, unit) for size, unit in rival.sizes) or UNSURE


def _chi2(value: float | None) -> str:
    return f"{value:.0f}" if value is not None and value >= 100.0 else digits(value, ".2g")


def _findable(verdict: Verdict) -> list[Html]:
    known = {k: f for k, f in verdict.smallest_findable.items() if f.value is not None}
    blind = blind_causes(verdict)
    rows = [(spoken(label), quantity(f.value, f.unit)) for label, f in known.items()]
    parts = [
        paragraph(findable_sentence(verdict), "note"),
        table(("cause", "smallest size"), rows),
    ]
    if len(rows) > 3 * SHOWN:
        parts = [parts[0], folded(f"{len(rows)} causes", parts[1])]
    if blind:
        parts.append(
            paragraph(
                f"Nothing can be said about: {', '.join(blind)}. What even the largest size tried"
                " would change here is no more than noise and commissioning errors may."
            )
        )
    return parts


def _leftover(verdict: Verdict) -> list[Html]:
    left = verdict.leftover
    if left is None:
        return []
    parts = [paragraph(f"Mean square of what is left: {left.mean_square:.3g} (1 is noise).")]
    if not left.loud:
        most = digits(verdict.statistics.misfit_threshold)
        said = (
            f"No band and no stretch of time passes {most} sigma, the most that machines in order"
        )
        return [*parts, paragraph(f"{said} leave in these recordings.")]
    if left.onset is not None:
        parts.append(paragraph(f"First stretch beyond noise: from {left.onset:.2f} s."))
    head = ("recording", "channel", "where", "score, sigma", "share of what is left")
    rows = [
        (
            loud.recording,
            loud.channel,
            ends_words(loud),
            digits(loud.score),
            f"{100.0 * loud.share:.0f} %",
        )
        for loud in left.loud
    ]
    goes = [
        f"{f.channel} goes along with {f.shape} (correlation {f.correlation:+.2f})"
        for f in left.features
        if abs(f.correlation) > 0.1 and f.shape != f.channel
    ]
    return [*parts, table(head, rows), bullets(goes)]


def _credibility(verdict: Verdict) -> list[Html]:
    rows = [(one.name, one.standing.value, one.said) for one in credibility(verdict)]
    note = "The eight factors of NASA-STD-7009. The project's own are on its page Credibility."
    return [paragraph(note, "note"), table(("factor", "standing", "on what"), rows)]


def _next(verdict: Verdict) -> list[Html]:
    parts = [bullets(next_sentences(verdict))]
    if verdict.next_experiment:
        rows = [(p.programme, _chi2(p.separation)) for p in verdict.next_experiment]
        parts.append(table(("programme", "chi^2 between the likest rivals"), rows))
    return parts
