"""Tolerance: how large a gap may be, in SI, and what exceeds it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.signals import Signal
from ves_twin.core.toml_file import check_schema, read_toml
from ves_twin.core.units import to_si
from ves_twin.diagnosis.record.residuals.channel import ChannelComparison

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
    """Limits in SI: measure -> column -> limit; and the unit of each column."""

    limits: Mapping[str, Mapping[str, float]]
    units: Mapping[str, str]

    @staticmethod
    def load(path: str | Path, signals: Mapping[str, Signal]) -> Tolerance:
        """A tolerance from a TOML file.

        Tables [rms], [peak] and [mean] hold limits by signal or column: a number in SI, a text
        with a unit, or for a signal a list with one for each column. In a signal of several units
        a single limit must be a text, and holds for the columns of its unit.

        Args:
            path: the file.
            signals: that may be compared, by name.

        Raises:
            FileAccessError: missing or unreadable.
            UnknownNameError: unknown table, signal or column.
            InvalidInputError: not a limit above zero in the right unit.
            VersionError: another version of the format.
        """
        content, _ = read_toml("tolerance", Path(path))
        check_schema(content, Path(path), SCHEMA)
        limits: dict[str, dict[str, float]] = {}
        units = {c: u for s in signals.values() for c, u in zip(s.columns, s.units, strict=True)}
        for measure, table in content.items():
            if measure == "schema":
                continue
            if measure not in MEASURES:
                raise UnknownNameError(f"table in {Path(path).name}", measure, MEASURES)
            if not isinstance(table, dict):
                raise InvalidInputError(f"{Path(path).name}: {measure}", table, "a table")
            limits[measure] = {}
            for key, value in flat_keys(table):
                where = f"{Path(path).name}: {measure}.{key}"
                limits[measure] |= _columns(key, value, where, signals, units)
        if not any(limits.values()):
            raise InvalidInputError(f"tolerance {Path(path).name}", "no limit", "at least one")
        return Tolerance(limits, units)

    def excesses(self, recording: str, channels: Iterable[ChannelComparison]) -> tuple[Excess, ...]:
        """Limits that a recording does not keep; a column that was not compared keeps none.

        A column that was compared in several modes keeps its limit if it does in each.
        """
        every = tuple(channels)
        found = []
        for measure, limits in self.limits.items():
            for name, limit in limits.items():
                values = [abs(float(getattr(c, measure))) for c in every if c.name == name]
                largest = max(values, default=None)
                if largest is None or largest > limit:
                    unit = self.units[name]
                    found.append(Excess(recording, name, measure, largest, limit, unit))
        return tuple(found)


def flat_keys(table: Mapping[str, object], prefix: str = "") -> list[tuple[str, object]]:
    """Entries of nested tables by dotted key: TOML splits a bare `leg.length`."""
    found: list[tuple[str, object]] = []
    for key, value in table.items():
        name = f"{prefix}{key}"
        found += flat_keys(value, f"{name}.") if isinstance(value, dict) else [(name, value)]
    return found


def _columns(
    key: str,
    value: object,
    where: str,
    signals: Mapping[str, Signal],
    units: Mapping[str, str],
) -> dict[str, float]:
    if key in signals:
        return _of_signal(signals[key], value, where)
    if key in units:
        return {key: _limit(value, units[key], where)}
    raise UnknownNameError(f"signal or column in {where.split(':')[0]}", key, [*signals, *units])


def _of_signal(signal: Signal, value: object, where: str) -> dict[str, float]:
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
