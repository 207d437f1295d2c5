"""Tolerance: how large a gap may be, in SI, and what exceeds it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.signals import SIGNALS
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.units import to_si
from ves_twin.diagnosis.residuals.channel import ChannelComparison
from ves_twin.scenario.experiment import COMPARABLE

MEASURES = ("rms", "peak", "mean")
SCHEMA = 1


@dataclass(frozen=True)
class Excess:
    """One limit that is not shown to be kept.

    Attributes:
        recording: name of the recording.
        channel: column.
        measure: "rms", "peak" or "mean".
        found: what was found [unit]; None if the column could not be compared.
        limit: what was allowed [unit].
        unit: SI unit.
    """

    recording: str
    channel: str
    measure: str
    found: float | None
    limit: float
    unit: str


@dataclass(frozen=True)
class Tolerance:
    """Limits in SI: measure -> column -> limit."""

    limits: Mapping[str, Mapping[str, float]]

    @staticmethod
    def load(path: str | Path) -> Tolerance:
        """A tolerance from a TOML file.

        Tables [rms], [peak] and [mean] hold limits by signal or column: a number in SI, a text
        with a unit, or for a signal a list with one for each column. In a signal of several units
        a single limit must be a text, and holds for the columns of its unit.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: unknown table, signal or column.
            InvalidInputError: not a limit above zero in the right unit.
            VersionError: another version of the format.
        """
        content, _ = read_toml("tolerance", Path(path))
        check_schema(content, Path(path), SCHEMA)
        limits: dict[str, dict[str, float]] = {}
        for measure, table in content.items():
            if measure == "schema":
                continue
            if measure not in MEASURES:
                raise UnknownNameError(f"table in {Path(path).name}", measure, MEASURES)
            if not isinstance(table, dict):
                raise InvalidInputError(f"{Path(path).name}: {measure}", table, "a table")
            limits[measure] = {}
            for key, value in flat_keys(table):
                limits[measure] |= _columns(key, value, f"{Path(path).name}: {measure}.{key}")
        if not any(limits.values()):
            raise InvalidInputError(f"tolerance {Path(path).name}", "no limit", "at least one")
        return Tolerance(limits)

    def excesses(self, recording: str, channels: Iterable[ChannelComparison]) -> tuple[Excess, ...]:
        """Limits that a recording does not keep; a column that was not compared keeps none."""
        known = {channel.name: channel for channel in channels}
        found = []
        for measure, limits in self.limits.items():
            for name, limit in limits.items():
                channel = known.get(name)
                value = None if channel is None else abs(float(getattr(channel, measure)))
                if value is None or value > limit:
                    found.append(Excess(recording, name, measure, value, limit, _unit(name)))
        return tuple(found)


def flat_keys(table: Mapping[str, object], prefix: str = "") -> list[tuple[str, object]]:
    """Entries of nested tables by dotted key: TOML splits a bare `leg.length`."""
    found: list[tuple[str, object]] = []
    for key, value in table.items():
        name = f"{prefix}{key}"
        found += flat_keys(value, f"{name}.") if isinstance(value, dict) else [(name, value)]
    return found


def _columns(key: str, value: object, where: str) -> dict[str, float]:
    columns = {
        c: u for n in COMPARABLE for c, u in zip(SIGNALS[n].columns, SIGNALS[n].units, strict=True)
    }
    if key in columns:
        return {key: _limit(value, columns[key], where)}
    if key not in COMPARABLE:
        raise UnknownNameError(
            f"signal or column in {where.split(':')[0]}", key, [*COMPARABLE, *columns]
        )
    signal = SIGNALS[key]
    if isinstance(value, list):
        if len(value) != signal.width:
            raise InvalidInputError(where, value, f"{signal.width} limits, or one")
        rows = zip(signal.columns, signal.units, value, strict=True)
        return {c: _limit(v, u, where) for c, u, v in rows}
    kinds = dict.fromkeys(signal.units)
    if len(kinds) == 1:
        limit = _limit(value, signal.units[0], where)
        return dict.fromkeys(signal.columns, limit)
    for unit in kinds:
        try:
            limit = _limit(value, unit, where) if isinstance(value, str) else 0.0
        except InvalidInputError:
            continue
        if limit > 0.0:
            rows_of = zip(signal.columns, signal.units, strict=True)
            return {c: limit for c, u in rows_of if u == unit}
    raise InvalidInputError(where, value, f"a text with a unit ({' or '.join(kinds)}), or a list")


def _limit(value: object, unit: str, where: str) -> float:
    limit = to_si(value, unit, where)
    if limit <= 0.0:
        raise InvalidInputError(where, value, f"a limit above zero in {unit}")
    return limit


def _unit(column: str) -> str:
    return next(
        unit
        for name in COMPARABLE
        for c, unit in zip(SIGNALS[name].columns, SIGNALS[name].units, strict=True)
        if c == column
    )
