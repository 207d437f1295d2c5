"""inspection_text: an inspection as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from ves_twin.data.clock.clock_report import ClockReport
from ves_twin.data.inspect_log import ChannelReport, Inspection, TableReport

HELD = 0.7
"""A column that changes in a smaller share of the rows is slower than its clock."""


def inspection_text(inspection: Inspection) -> str:
    """File, then each table with its clock and its channels, then what cannot be read."""
    size = inspection.size / 1e6
    lines = [f"{inspection.file}: {inspection.form}, {size:.1f} MB"]
    for table in inspection.tables:
        lines += ["", *_table(table)]
    lines += [f"  not read: {fault}" for fault in inspection.faults]
    return "\n".join(lines)


def _table(table: TableReport) -> Iterator[str]:
    yield f"{table.name or 'columns'}: {table.rows} rows"
    if table.clock is None:
        yield "  clock: none found; a map can give a rate, or name the column"
    else:
        yield f"  clock: {_clock(table.clock)}"
        for gap in () if table.clock.uneven else table.clock.longest:
            since = gap.start - table.clock.start
            yield f"    gap of {gap.length:.4g} s, {since:.6g} s from the start"
    if table.candidates:
        yield f"  rising too: {', '.join(table.candidates)}"
    if not table.channels:
        return
    width = max(len(c.name) for c in table.channels)
    yield f"  {'channel':<{width}}  {'unit':<8}{'from':>13}{'to':>13}   ({table.basis})"
    for channel in table.channels:
        yield "  " + _channel(channel, table, width)


def _clock(clock: ClockReport) -> str:
    unit = f"{clock.unit}{' by a guess' if clock.guessed else ''}"
    words = [f"{clock.column} [{unit}]"]
    if clock.uneven:
        mean = (clock.rows - 1) / (clock.stop - clock.start)
        longest = clock.longest[0].length
        words.append(f"uneven, {mean:.4g} Hz on average, steps up to {longest:.3g} s")
    elif clock.period > 0.0:
        words.append(f"{clock.rate:.6g} Hz, jitter {clock.jitter:.1%}")
    words.append(f"{clock.start:.9g} to {clock.stop:.9g} s")
    counted = (
        (0 if clock.uneven else clock.gaps, "gaps"),
        (clock.repeats, "repeated times"),
        (clock.back, "steps back"),
        (clock.missing, "rows without a time"),
    )
    words += [f"{number} {what}" for number, what in counted if number]
    return ", ".join(words)


def _channel(channel: ChannelReport, table: TableReport, width: int) -> str:
    head = f"{channel.name:<{width}}  {channel.unit or '?':<8}"
    if channel.low is None or channel.high is None:
        return f"{head}  {'no numbers' if channel.kind.value != 'text' else 'text'}"
    notes = [channel.said] if channel.said else []
    if channel.missing:
        notes.append(f"{channel.missing} missing")
    if channel.low == channel.high:
        notes.append("constant")
    elif channel.changes is not None and 0.0 < channel.changes < HELD and table.clock:
        notes.append(f"changes at {channel.changes * table.clock.rate:.4g} Hz")
    return f"{head}{channel.low:>13.6g}{channel.high:>13.6g}   {', '.join(notes)}".rstrip()
