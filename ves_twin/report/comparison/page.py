"""comparison_page: a comparison as one HTML page, the answer on the first screen."""

from __future__ import annotations

from ves_twin.core.quantity import UNSURE, digits, percent, quantity
from ves_twin.data.quality.check import Grade
from ves_twin.diagnosis.record.residuals.channel import ChannelComparison
from ves_twin.machines.comparison import Basis, Comparison, RecordingComparison
from ves_twin.report.comparison.pictures import (
    OTHER,
    SIMULATED,
    cells_figure,
    cells_of,
    channel_figure,
    levels_figure,
    residuals_figure,
)
from ves_twin.report.comparison.words import (
    HELD_AGAINST,
    cost_sentence,
    envelope_sentence,
    excess_words,
    fed_words,
    gap_sentence,
    place_sentence,
    rests_on,
    tolerance_sentence,
    trust_sentence,
)
from ves_twin.report.html import Html, bullets, folded, joined, paragraph, section, table
from ves_twin.report.page import html_page

SHOWN = 4
"""Columns drawn large for each recording: the loudest."""

TONE = {Grade.PASSED: "good", Grade.FAILED: "bad", Grade.UNKNOWN: "open"}
"""Style of a paragraph."""


def comparison_page(comparison: Comparison) -> str:
    """The page: answer, then each recording by column, band, time and regime."""
    several = len(comparison.recordings) > 1
    parts = [_head(comparison)]
    for k, recording in enumerate(comparison.recordings):
        parts.append(_answer(recording, f"r{k + 1}", several))
    parts.append(_tolerance(comparison))
    for k, recording in enumerate(comparison.recordings):
        parts += _details(recording, f"r{k + 1}", several)
    parts.append(_reading(comparison))
    return html_page("Measured against expected", parts)


def _head(comparison: Comparison) -> Html:
    count = len(comparison.recordings)
    return paragraph(
        f"{count} recording{'s' if count > 1 else ''}, made by ves-twin compare.", "note"
    )


def _answer(recording: RecordingComparison, name: str, several: bool) -> Html:
    made = f", recorded from plant {recording.made_by}" if recording.made_by else ""
    span = (
        f"{recording.stop - recording.start + 1:g} poses"
        if recording.poses
        else f"{recording.start:.2f} to {recording.stop:.2f} s at {recording.rate:.2f} Hz"
    )
    what = (
        f"{recording.name}: {span}{made}, against {HELD_AGAINST[recording.basis]};"
        f" {fed_words(recording)}; plant {recording.plant} ({recording.plant_hash})."
    )
    loud = bool(recording.beyond_noise)
    parts = [
        paragraph(what, "lead" if several else ""),
        paragraph(trust_sentence(recording), TONE[recording.quality]),
        bullets(f"{c.name}: {c.message}" for c in recording.checks if c.grade is Grade.FAILED),
        paragraph(gap_sentence(recording), "bad" if loud else "good"),
    ]
    if recording.outside:
        parts.append(paragraph(envelope_sentence(recording)))
    if recording.channels:
        top = max(recording.channels, key=lambda c: (c.beyond_noise, c.loudness))
        other = SIMULATED if recording.basis is Basis.PLANT else OTHER
        parts.append(channel_figure(top, recording, other, f"{name}-answer"))
    parts.append(paragraph(f"Rests on: {rests_on(recording)}"))
    cost = cost_sentence(recording)
    if cost:
        parts.append(paragraph(cost))
    if recording.absent:
        parts.append(paragraph(f"Not compared, for want of data: {', '.join(recording.absent)}."))
    parts.append(bullets(place_sentence(c) for c in recording.beyond_noise[:SHOWN]))
    return joined(parts)


def _tolerance(comparison: Comparison) -> Html:
    kept = comparison.in_tolerance
    tone = "" if kept is None else "good" if kept else "bad"
    rest = [f"{e.recording}: {excess_words(e)}" for e in comparison.excesses or ()]
    return joined([paragraph(tolerance_sentence(comparison), tone), bullets(rest)])


def _details(recording: RecordingComparison, name: str, several: bool) -> list[Html]:
    title = f": {recording.name}" if several else ""
    other = SIMULATED if recording.basis is Basis.PLANT else OTHER
    loud = sorted(recording.channels, key=lambda c: (not c.beyond_noise, -c.loudness))[:SHOWN]
    if not recording.channels:
        return []
    return [
        section(f"How large{title}", levels_figure(recording, name), _channel_table(recording)),
        section(
            f"Where it lives{title}",
            *(cells_figure(recording, kind, name) for kind in _mapped(recording)),
            folded("Regimes: velocity, position, load", _regime_table(recording.channels)),
        ),
        section(
            f"The loudest columns{title}",
            *(channel_figure(c, recording, other, name) for c in loud),
            folded(
                "Residuals of all columns",
                residuals_figure(recording, name),
            ),
        ),
        section(
            f"Data and noise{title}",
            bullets(recording.notes),
            table(
                ("check", "answer", "what was found"),
                [(c.name, c.grade.value, c.message) for c in recording.checks],
            ),
        ),
    ]


def _mapped(recording: RecordingComparison) -> tuple[str, ...]:
    """Kinds of cells that some column has: poses have no bands, without noise there are none."""
    kinds = ("band", "time")
    return tuple(k for k in kinds if any(cells_of(c, k) for c in recording.channels))


def _channel_table(recording: RecordingComparison) -> Html:
    slow = "rms" if recording.poses else f"rms below {recording.slow_below:g} Hz"
    head = (
        *("column (* beyond noise)", "rms", slow, "sigma", "rms / sigma", "peak", "mean"),
        *("unexplained", "lag-one (noise)", "white", "lag, ms", "coherence (chance)"),
    )
    return table(head, [_row(c) for c in recording.channels])


def _row(c: ChannelComparison) -> tuple[str, ...]:
    white, lag, coherence = c.whiteness, c.lag, c.coherence
    return (
        f"{c.name}{' *' if c.beyond_noise else ''}",
        quantity(c.rms, c.unit),
        quantity(c.rms_slow, c.unit),
        quantity(c.sigma or None, c.unit),
        digits(c.rms_sigma),
        quantity(c.peak, c.unit),
        quantity(c.mean, c.unit),
        percent(c.unexplained),
        f"{white.lag_one:.2f} ({white.expected:.2f} +- {white.spread:.2f})" if white else UNSURE,
        ("yes" if white.white else "no") if white else "?",
        f"{lag.value * 1e3:.3f} +- {lag.sd * 1e3:.3f}" if lag else "?",
        f"{coherence.value:.2f} ({coherence.chance:.2f})" if coherence else UNSURE,
    )


def _regime_table(channels: tuple[ChannelComparison, ...]) -> Html:
    rows = [
        (
            c.name,
            cell.label,
            quantity(cell.rms, c.unit),
            digits(cell.sigma),
            quantity(cell.mean, c.unit),
        )
        for c in channels
        for cell in c.regimes
    ]
    return table(("column", "regime", "rms", "sigma", "mean, less that of the whole"), rows)


def _reading(comparison: Comparison) -> Html:
    versions = ", ".join(f"{name} {number}" for name, number in comparison.versions.items())
    return section(
        "How to read this",
        bullets(
            (
                "Residual = measured less expected. Sigma = sd of the noise of one row; a column is"
                " beyond noise if a band or a stretch has a score above 5 standard deviations, or"
                " its mean is further off than noise and zeroing allow.",
                "Beyond noise is not important, and important is not beyond noise: the tolerance"
                " and the cost for the emulation say what matters.",
                "Lag: measured later than expected is positive. Coherence: share of the residual"
                " that one column of the set-points explains linearly, and what chance gives."
                " A question mark: the data cannot tell.",
                "The page shows where data and plant part. It does not name the cause.",
            )
        ),
        paragraph(versions, "note"),
    )
