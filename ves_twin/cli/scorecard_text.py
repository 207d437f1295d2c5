"""scorecard_text: the scorecard and the figures as a person reads them in a terminal."""

from __future__ import annotations

from ves_twin.thesis.claim import Kind
from ves_twin.thesis.figures.figure import FigureResult
from ves_twin.thesis.page import chapter_title, input_sentence, score_sentence
from ves_twin.thesis.row import NOT_COMPUTED, Row
from ves_twin.thesis.scorecard import Scorecard
from ves_twin.thesis.verdict import Verdict
from ves_twin.thesis.words import asked_words, predicted_words, thesis_words, value_words

TOLD = (Verdict.REPRODUCED, Verdict.IN_KIND, Verdict.DIFFERS)
LEFT = (Verdict.NOT_BUILT, Verdict.NOT_TESTABLE, Verdict.NOT_RUN)


def scorecard_text(card: Scorecard, detailed: bool) -> str:
    """Every row in detail, or the score and a line for each claim that is no folded input."""
    if detailed:
        return "\n\n".join(_details(row) for row in card.rows)
    head = f"plant {card.plant} {card.plant_hash}, {'quick' if card.quick else 'full'} runs"
    lines = [head, score_sentence(card), input_sentence(card)]
    for chapter in dict.fromkeys(row.claim.chapter for row in card.rows):
        rows = [row for row in card.rows if row.claim.chapter == chapter]
        given = [row.claim.id for row in rows if row.verdict is Verdict.INPUT]
        lines += ["", chapter_title(chapter)]
        if given:
            lines.append(f"  {'input':<12}  {_span(given)}")
        lines += [_line(row) for row in rows if row.verdict in TOLD]
        lines += _left(rows)
    return "\n".join(lines)


def figure_text(figure: FigureResult) -> str:
    """A figure's numbers and where it was drawn."""
    width = max(map(len, figure.numbers), default=0)
    lines = [f"{figure.id}: {figure.title}"]
    lines += [f"  {name:<{width}}  {value:.4g}" for name, value in figure.numbers.items()]
    lines += [*(f"  {note}" for note in figure.notes), f"  drawn in {figure.png}"]
    return "\n".join(lines)


def _line(row: Row) -> str:
    mark = " (tuned on it)" if row.claim.calibrated_on else ""
    mark += " (input)" if row.claim.kind is Kind.INPUT else ""
    answer = f"{value_words(row) or row.note}; thesis {thesis_words(row.claim)}"
    return f"  {row.verdict.value:<12}  {row.claim.id}  {row.claim.quantity}{mark}: {answer}"


def _left(rows: list[Row]) -> list[str]:
    """A line for each thing not built, not testable or not run, with its claims."""
    left = [row for row in rows if row.verdict in LEFT]
    return [
        f"  {verdict:<12}  {', '.join(r.claim.id for r in left if r.note == note)}: {note}"
        for verdict, note in dict.fromkeys((row.verdict.value, row.note) for row in left)
    ]


def _details(row: Row) -> str:
    claim = row.claim
    fields = {
        "verdict": row.verdict.value,
        "thesis": f"{thesis_words(claim)} ({claim.where}, {claim.kind})",
        "asked": asked_words(claim),
        "twin": value_words(row),
        "how" if row.values or row.runs else "why": row.note,
        "tuned on it": claim.calibrated_on,
        "without it": predicted_words(row) or NOT_COMPUTED if claim.calibrated_on else "",
        "figure": claim.figure,
        "again": row.command,
    }
    lines = [f"{claim.id}  {claim.quantity}"]
    lines += [f"  {name:<12} {text}" for name, text in fields.items() if text]
    return "\n".join([*lines, *(f"  {'run':<12} {run}" for run in row.runs)])


def _span(ids: list[str]) -> str:
    return f"{', '.join(ids)}: in the twin as given"
