"""scorecard_page: the scorecard as a page of Markdown, the score first."""

from __future__ import annotations

from collections.abc import Iterable

from ves_twin.thesis.claim import Kind
from ves_twin.thesis.row import NOT_COMPUTED, Row
from ves_twin.thesis.scorecard import Scorecard
from ves_twin.thesis.verdict import Verdict
from ves_twin.thesis.words import asked_words, predicted_words, thesis_words, value_words

SHOWN = (Verdict.REPRODUCED, Verdict.IN_KIND, Verdict.DIFFERS)
LEFT = (Verdict.NOT_BUILT, Verdict.NOT_TESTABLE, Verdict.NOT_RUN)
HEAD = (
    "| claim | what | thesis | asked | twin | verdict | how, or why not |\n"
    "|---|---|---|---|---|---|---|"
)


def scorecard_page(card: Scorecard) -> str:
    """The page: score, what differs, what was tuned, then every chapter."""
    chapters = dict.fromkeys(row.claim.chapter for row in card.rows)
    parts = [
        *_top(card),
        *_differences(card),
        *_calibrated(card),
        *(line for name in chapters for line in _chapter(card, name)),
    ]
    return "\n".join(parts).rstrip() + "\n"


def chapter_title(chapter: str) -> str:
    """Title of a chapter's number or an appendix's letter."""
    return f"{'Chapter' if chapter.isdigit() else 'Appendix'} {chapter}"


def score_sentence(card: Scorecard) -> str:
    """The headline in words."""
    score = card.score
    counts = ", ".join(
        f"{score[v]} {'differ' if v is Verdict.DIFFERS and score[v] != 1 else v}"
        for v in Verdict
        if v is not Verdict.INPUT and (v is not Verdict.NOT_RUN or card.quick)
    )
    return (
        f"Of {len(card.rows)} claims, {sum(score.values())} are neither inputs nor were used in"
        f" calibration. Of these: {counts}."
    )


def input_sentence(card: Scorecard) -> str:
    """How many inputs the twin has as given."""
    inputs = card.inputs
    off = _ids(r for r in card.rows if _is_input(r) and r.verdict is Verdict.DIFFERS)
    return (
        f"{sum(inputs.values())} inputs: {inputs['input']} are in the twin as given,"
        f" {inputs['differs']} differ{f' ({off})' if off else ''},"
        f" {inputs['not built']} not built, {inputs['not testable']} not testable."
    )


def _top(card: Scorecard) -> list[str]:
    quick = "`--quick` (shorter runs, some on the `fast` rig)" if card.quick else "full runs"
    return [
        "# Scorecard of the thesis",
        "",
        f"**{score_sentence(card)}**",
        "",
        f"{input_sentence(card)} {len(card.calibrated)} claims were used to tune the twin; they"
        " prove nothing and are listed apart.",
        "",
        f"Output of `ves-twin reproduce` for plant `{card.plant}` ({card.plant_hash}), {quick},"
        f" emulated models as in the {card.models}; `make scorecard` writes it anew. One row:"
        " `ves-twin reproduce C072`; with `--json` also the commands of the simulations behind it.",
        "",
        "*Reproduced*: within the tolerance asked. *In kind*: the thesis has words, or the number"
        " is met less sharply; what suffices was fixed beforehand. *Differs*: neither."
        " *Not built*: the twin lacks what would answer. *Not testable*: no twin can answer."
        " E-n: the print is in error there; what is asked is the corrected value where one stands.",
        "",
    ]


def _differences(card: Scorecard) -> list[str]:
    rows = [row for row in card.rows if row.verdict is Verdict.DIFFERS]
    if not rows:
        return []
    lines = [
        f"- {row.claim.id}{' (input)' if _is_input(row) else ''}, {row.claim.quantity}: twin"
        f" {value_words(row) or 'nothing'}, asked {_target(row)}. {_sentence(row.note)}"
        for row in rows
    ]
    lines = [line.replace("*", "\\*") for line in lines]  # N*m twice would be emphasis
    return ["## What differs", "", *lines, ""]


def _calibrated(card: Scorecard) -> list[str]:
    if not card.calibrated:
        return []
    lines = [
        "## Used in calibration, not in the score",
        "",
        "| claim | what | thesis | tuned on it | twin | predicted by a rig tuned without it |",
        "|---|---|---|---|---|---|",
    ]
    for row in card.calibrated:
        claim = row.claim
        cells = (claim.id, claim.quantity, thesis_words(claim), claim.calibrated_on)
        told = value_words(row) or row.verdict.value
        lines.append(_line((*cells, told, predicted_words(row) or NOT_COMPUTED)))
    return [*lines, ""]


def _chapter(card: Scorecard, chapter: str) -> list[str]:
    rows = [row for row in card.rows if row.claim.chapter == chapter]
    told = [row for row in rows if not _is_input(row) and row.verdict in SHOWN]
    lines = [f"## {chapter_title(chapter)}", ""]
    if told:
        lines += [HEAD, *(_table_row(row) for row in told), ""]
    for verdict in LEFT:
        left = [row for row in rows if row.verdict is verdict]
        for note in dict.fromkeys(row.note for row in left):
            same = ", ".join(row.claim.id for row in left if row.note == note)
            lines.append(f"- {verdict.value.capitalize()}: {same}: {note}.")
    if lines[-1]:
        lines.append("")
    return lines + _folded_inputs([row for row in rows if _is_input(row) and value_words(row)])


def _folded_inputs(rows: list[Row]) -> list[str]:
    if not rows:
        return []
    title = f"<details><summary>Inputs: {_ids(rows)}</summary>"
    return [title, "", HEAD, *(_table_row(row) for row in rows), "", "</details>", ""]


def _table_row(row: Row) -> str:
    claim = row.claim
    what = f"{claim.quantity} ({claim.where})"
    verdict = f"{row.verdict}{', tuned' if claim.calibrated_on else ''}"
    cells = (claim.id, what, thesis_words(claim), asked_words(claim), value_words(row))
    return _line((*cells, verdict, row.note))


def _target(row: Row) -> str:
    claim = row.claim
    asked = asked_words(claim)
    relative = asked.startswith(("+-", "exact"))
    return f"{thesis_words(claim)} {asked}" if relative else asked


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def _ids(rows: Iterable[Row]) -> str:
    return ", ".join(row.claim.id for row in rows)


def _is_input(row: Row) -> bool:
    return row.claim.kind is Kind.INPUT


def _line(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"
