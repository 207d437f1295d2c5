"""resolve: each channel of a map as a column of the file and a column of a signal."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VesTwinError
from ves_twin.core.signals import SIGNALS, Signal
from ves_twin.core.units import to_unit
from ves_twin.data.formats.log import Kind, Log
from ves_twin.data.mapping.import_map import MAIN, Channel, ImportMap

SLIP = 0.85
"""Likeness of a name to one of VES II from which on it is taken for a slip of the pen: a letter or
two; "joint.torque.3" of another machine is no "arm.torque.3"."""

COLUMN = re.compile("[1-9][0-9]{0,2}")
"""Number of a column of a signal of one's own; a larger one is taken for a slip of the pen."""


@dataclass(frozen=True)
class Target:
    """Where a channel comes from and where it goes.

    Attributes:
        channel: as the map has it.
        table: of the file.
        name: of the column in that table.
        signal: that it becomes part of.
        column: of the signal, from 0.
        unit: of the file's numbers.
    """

    channel: Channel
    table: str
    name: str
    signal: Signal
    column: int
    unit: str

    @property
    def place(self) -> tuple[str, str]:
        """Table and column."""
        return self.table, self.name

    @property
    def si(self) -> str:
        """Unit of the signal's column."""
        return self.signal.units[self.column]

    @property
    def conversion(self) -> str:
        """What is done to the numbers, in words."""
        c = self.channel
        said = [f"times {c.scale:g}"] if c.scale != 1.0 else []
        said += [f"{c.offset:+g}"] if c.offset else []
        said += (
            [f"{self.unit} converted to {self.si}"] if self.unit != self.si else [f"in {self.si}"]
        )
        said += ["sign turned"] if c.sign < 0 else []
        return ", ".join(said)


def resolve(log: Log, told: ImportMap, given: Sequence[Signal] = ()) -> tuple[Target, ...]:
    """Every channel of a map.

    Args:
        log: the file.
        told: the map.
        given: signals of an MJCF machine, in place of those of VES II.

    Raises:
        UnknownNameError: a column, signal, clock or frame that does not exist, with the nearest.
        InvalidInputError: a text, no unit, or one of another dimension.
    """
    names = log.full_names()
    plant = {s.name: s for s in given} or SIGNALS
    own = {s.name: s for s in _own_signals(told)}
    for both in own.keys() & plant.keys():
        if own[both].units != plant[both].units:
            wanted = f"{', '.join(plant[both].units)}, as the rig has it"
            raise InvalidInputError(f"units of signals.{both}", own[both].units, wanted)
    signals = {**own, **plant}
    columns = {c: (s, i) for s in signals.values() for i, c in enumerate(s.columns)}
    found = []
    for channel in told.channel:
        where = f"column in {log.path.name}"
        if channel.from_ not in names:
            raise UnknownNameError(where, channel.from_, names)
        table, column = names[channel.from_]
        if column.kind is Kind.TEXT:
            raise InvalidInputError(f"{where} {channel.from_}", "a text", "numbers")
        if channel.to not in columns:
            raise _unknown(channel.to, columns, bool(given))
        for kind, name, known in (
            ("clock", channel.clock, {MAIN, *told.clocks}),
            ("frame", channel.frame, set(told.frames)),
        ):
            if name is not None and name not in known:
                raise UnknownNameError(f"{kind} of {channel.from_}", name, known)
        signal, place = columns[channel.to]
        unit = channel.unit or column.unit
        if not unit:
            wanted = f'unit = "..."; {channel.to} is in {signal.units[place]}'
            raise InvalidInputError(f"unit of {channel.from_}", "none in file or map", wanted)
        to_unit(unit, signal.units[place], f"unit of {channel.from_} for {channel.to}")
        found.append(Target(channel, table.name, column.name, signal, place, unit))
    _check_frames(found)
    return tuple(found)


def _unknown(name: str, columns: Collection[str], machine: bool) -> VesTwinError:
    """What to raise; of VES II, which was not asked for, only a name that is a slip of the pen."""
    if machine or difflib.get_close_matches(name, columns, n=1, cutoff=SLIP):
        return UnknownNameError("signal column", name, columns)
    expected = "a signal of VES II, of the machine that --plant names, or of the map's [signals]"
    return VesTwinError(f"unknown signal column '{name}'; expected {expected}")


def _own_signals(told: ImportMap) -> list[Signal]:
    found = []
    for name, own in told.signals.items():
        places = [
            c.to.removeprefix(f"{name}.") for c in told.channel if c.to.startswith(f"{name}.")
        ]
        width = max([1, *(int(p) for p in places if COLUMN.fullmatch(p))])
        found.append(own.signal(name, width))
    return found


def _check_frames(targets: list[Target]) -> None:
    """A vector is turned whole, or not at all."""
    for name in {t.signal.name for t in targets}:
        here = [t for t in targets if t.signal.name == name]
        frames = {t.channel.frame for t in here}
        turned = frames != {None}
        if turned and (len(frames) > 1 or len(here) < here[0].signal.width):
            came = (
                f"{len(here)} of {here[0].signal.width} columns, frames {sorted(map(str, frames))}"
            )
            raise InvalidInputError(f"frame of {name}", came, "every column, in one frame")
