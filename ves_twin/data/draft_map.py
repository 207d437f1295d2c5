"""draft_map: a map to edit, with what the file tells filled in and guesses as comments."""

from __future__ import annotations

import difflib
import json
import re

from ves_twin.core.signals import SIGNALS, Role
from ves_twin.data.clock.clock_report import ClockReport
from ves_twin.data.formats.log import Kind
from ves_twin.data.formats.unit_names import bare_name
from ves_twin.data.inspect_log import ChannelReport, Inspection

HEAD = """\
# Map of {file} for `ves-twin import FILE --map THIS --out REC.parquet`.
# What is not commented is taken as it stands; check units, signs and every line marked "guess".
schema = 1
# rate = "100 Hz"          # even rows at this rate; without it the main clock's own rows
# gaps = "nan"             # what stands in a gap: nan, or hold (the value before it)
# [window]
# start = "0 s"
# stop = "60 s"
"""

JITTER = 0.05
"""Deviation of a step [periods] from which on a draft says what can be done about it."""

CLOSE = 0.75
"""Likeness of names that is enough for a guess."""


def draft_map(inspection: Inspection) -> str:
    """The text of a map: the main clock, then a channel for each column of numbers.

    A column that has a signal's name goes there; one that looks like it is guessed in a comment;
    any other gets a signal of its own, commented out.
    """
    lines = [HEAD.format(file=inspection.file.replace("\\", "/").rpartition("/")[2])]
    lines += _clock(inspection)
    taken: set[str] = set()
    for table in inspection.tables:
        rate = f" at {table.clock.rate:.6g} Hz" if table.clock else ""
        lines.append(f"\n# {table.name or 'columns'}: {table.rows} rows{rate}")
        for channel in table.channels:
            if channel.kind is Kind.NUMBER and channel.low is not None:
                lines += _channel(channel, taken)
    return "\n".join(lines) + "\n"


def _clock(inspection: Inspection) -> list[str]:
    tables = [t for t in inspection.tables if t.clock is not None]
    if not tables:
        return ["[clock]", 'rate = "1 kHz"   # guess: no column of the file looks like a time', ""]
    clock = max(tables, key=lambda t: t.rows).clock
    lines = ["[clock]", f"column = {_quoted(clock.column if clock else '')}"]
    if clock is not None:
        lines += _clock_lines(clock)
    others = [name for t in tables for name in t.candidates]
    if others:
        lines.append(f"# other columns that rise like a clock: {', '.join(others[:8])}")
    return [*lines, ""]


def _clock_lines(clock: ClockReport) -> list[str]:
    lines = [f"unit = {_quoted(clock.unit)}" + ("   # guess" if clock.guessed else "")]
    if clock.jitter > JITTER:
        words = f"steps jitter by up to {clock.jitter:.0%}; true draws the stamps straight"
        lines.append(f"# even = false   # {words}")
    if clock.back:
        words = f'{clock.back} steps back; "drop" or "sort" them'
        lines.append(f'# backward = "refuse"   # {words}')
    if clock.repeats:
        lines.append(f'# repeats = "first"   # {clock.repeats} repeated times; or "last", "refuse"')
    return lines


def _channel(channel: ChannelReport, taken: set[str]) -> list[str]:
    exact = _exact(channel.name)
    guess = exact or _guess(channel.name)
    guess = None if guess in taken else guess
    taken |= {guess} if guess else set()
    seen = f"# {channel.low:.6g} to {channel.high:.6g} {channel.unit or '(unit unknown)'}"
    lines = [
        "[[channel]]",
        f"from = {_quoted(channel.name)}   {seen}",
        f"to = {_quoted(guess or _own_name(channel.name))}" + ("" if exact else "   # guess"),
        f"unit = {_quoted(channel.unit or '?')}" + ("" if channel.unit else "   # say it"),
    ]
    if guess is None:
        own = (
            f"# [signals.{_quoted(_own_name(channel.name))}]   # a signal of your own needs a unit"
        )
        lines.append(own)
        lines.append(f"# unit = {_quoted(channel.unit or '?')}")
    if exact is None:
        lines = [line if line.startswith("#") else f"# {line}" for line in lines]
    else:
        lines.append("# sign = -1; scale = 1.0; offset = 0.0")
    return ["", *lines]


def _exact(name: str) -> str | None:
    bare = bare_name(name)
    for signal in SIGNALS.values():
        if bare in signal.columns and signal.role is not Role.TRUTH:
            return bare
        for i, column in enumerate(signal.columns):
            if bare == (signal.field if signal.width == 1 else f"{signal.field}.{i + 1}"):
                return column
    return None


WORDS = {
    "leg.command": ("leg command", "leg cmd", "l cmd", "leg set", "stroke cmd"),
    "leg.length": ("leg length", "leg", "l", "stroke", "length"),
    "valve.command": ("valve command", "valve", "spool", "u valve"),
    "arm.command": ("arm command", "q cmd", "joint cmd", "q set", "q ref"),
    "arm.q": ("arm q", "q", "joint", "joint angle", "q meas"),
    "arm.torque": ("arm torque", "tau", "torque", "joint torque"),
    "sensor.wrench": ("wrench", "f", "force", "ft"),
}
"""Signal -> names, before their number, that laboratories give its columns."""


def _guess(name: str) -> str | None:
    """The signal column whose usual names are nearest, by words and number."""
    bare = re.sub(r"[\W_]+", " ", bare_name(name)).strip().lower()
    axes = {"fx": 1, "fy": 2, "fz": 3, "mx": 4, "my": 5, "mz": 6, "tx": 4, "ty": 5, "tz": 6}
    if bare.split()[-1:] and bare.split()[-1] in axes:
        signal = "gravity.estimate" if "grav" in bare else "sensor.wrench"
        return f"{signal}.{axes[bare.split()[-1]]}"
    number = re.search(r"(\d)", bare)
    if number is None:
        return "supply.pressure" if "pressure" in bare and "supply" in bare else None
    stem = re.sub(r"\s+", " ", bare.replace(number[1], " ", 1)).strip()
    scores = {
        signal: max(difflib.SequenceMatcher(None, stem, word).ratio() for word in words)
        for signal, words in WORDS.items()
    }
    best = max(scores, key=lambda signal: scores[signal])
    column = f"{best}.{number[1]}"
    good = scores[best] >= CLOSE and column in SIGNALS[best].columns
    return column if good else None


def _own_name(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.]+", "_", bare_name(name)).strip("_.").lower() or "signal"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
