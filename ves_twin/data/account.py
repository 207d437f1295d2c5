"""Account: what an import did to a lab file, as text and as plain values."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class ChannelAccount:
    """One column: from where to where, how converted, how it got onto the rows."""

    source: str
    target: str
    conversion: str
    how: str
    missing: float


@dataclass(frozen=True)
class Account:
    """What was done.

    Attributes:
        file: name of the lab file.
        form: its kind.
        sha256: of its bytes.
        rows: of the recording.
        rate: usual rate of the rows [Hz].
        zero: reading of the main clock at t = 0 [s].
        clocks: rows, rate, gaps, repeats, steps back of each.
        offsets: what was found of other clocks, with sd, removed or not.
        channels: one for each column.
        notes: what else was done.
        suspected: mixed units, where values lie outside the plant's range.
        checks: of the gate, those that failed.
        faults: what could not be read.
    """

    file: str
    form: str
    sha256: str
    rows: int
    rate: float
    zero: float
    clocks: dict[str, dict[str, object]]
    offsets: dict[str, dict[str, object]]
    channels: tuple[ChannelAccount, ...]
    notes: tuple[str, ...]
    suspected: tuple[str, ...]
    checks: tuple[str, ...]
    faults: tuple[str, ...]

    def to_dict(self) -> dict[str, object]:
        """Plain values for JSON."""
        return asdict(self)

    def to_text(self) -> str:
        """Lines for a terminal."""
        lines = [
            f"{self.file} ({self.form}): {self.rows} rows at {self.rate:.6g} Hz,"
            f" t = 0 at {self.zero:.9g} s of its clock"
        ]
        for name, clock in self.clocks.items():
            lines.append(f"  clock {name}: {_clock_words(clock)}")
        width = max(len(c.source) for c in self.channels)
        for c in self.channels:
            missing = f"; {c.missing:.2%} missing" if c.missing else ""
            lines.append(f"  {c.source:<{width}}  {c.target}: {c.conversion}, {c.how}{missing}")
        for head, words in (
            ("note", self.notes),
            ("SUSPECTED", self.suspected),
            ("check", self.checks),
            ("not read", self.faults),
        ):
            lines += [f"  {head}: {one}" for one in words]
        return "\n".join(lines)


def _clock_words(clock: dict[str, object]) -> str:
    words = [f"{clock['rows']} rows at {clock['rate']:.6g} Hz"]
    if clock["gaps"]:
        words.append(f"{clock['gaps']} gaps, the longest of {clock['longest_gap']:.4g} s")
    if clock["repeats"]:
        words.append(f"{clock['repeats']} repeated times left out")
    if clock["back"]:
        words.append(f"{clock['back']} steps back")
    if clock["missing"]:
        words.append(f"{clock['missing']} rows without a time left out")
    return ", ".join(words)
