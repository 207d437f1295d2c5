"""McapLog: topics of an MCAP file; each message a row, its numbers columns."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Iterator, Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass
from io import StringIO
from itertools import islice
from pathlib import Path
from typing import IO, Any

import numpy as np

from ves_twin.core.errors import InvalidInputError, VesTwinError, one_line
from ves_twin.core.types import FloatArray
from ves_twin.data.formats.limits import Limits
from ves_twin.data.formats.log import Block, Column, Extremes, KnownRanges, Log, Table
from ves_twin.data.formats.message_fields import Path as FieldPath
from ves_twin.data.formats.message_fields import (
    all_elements,
    element_names,
    long_arrays,
    number_at,
    number_paths,
    path_name,
)
from ves_twin.data.formats.ros1_messages import ros1_decoder

try:
    from mcap.data_stream import ReadDataStream
    from mcap.records import Channel, Chunk, ChunkIndex, McapRecord, Message, Schema, Statistics
    from mcap.stream_reader import StreamReader
    from mcap_protobuf.decoder import DecoderFactory as ProtobufFactory
    from mcap_ros2.decoder import DecoderFactory as Ros2Factory

    from ves_twin.data.formats.mcap_chunk import records_in, summary_in, unfold
except ImportError as error:
    raise VesTwinError(
        f"MCAP files need packages that are not installed ({error.name}):"
        " pip install 'ves_twin[mcap]'"
    ) from None

LOG, PUBLISH = "log_time", "publish_time"
ROWS = 4096
"""Messages of a block."""

SAMPLED = 2000
"""Messages whose ranges stand for a topic with many more."""

MANY = 10_000

NAMING = 64
"""Messages whose names of elements are known: several nodes may publish on one topic in turn."""

JSON_WEIGHT = 4
"""Times that a byte of JSON counts as one of a message: as Python's lists it takes twenty."""

WIDEST = 4096
"""Numbers of a message that become columns; a topic with more is left out."""

DECODED = "JSON, protobuf, ROS 2 (cdr with ros2msg) and ROS 1 (ros1msg)"


@dataclass(frozen=True)
class _Topic:
    """One channel of the file.

    Attributes:
        id: of the channel.
        decode: its decoder.
        paths: fields that are numbers, by their names.
        elements: what its messages call the elements of their arrays; () if nothing.
        named: arrays that have an element for each name.
    """

    id: int
    decode: Callable[[bytes], Any] | None
    paths: dict[str, FieldPath]
    elements: tuple[str, ...] = ()
    named: frozenset[str] = frozenset()

    def said(self, column: str) -> str:
        """Element and field of an array's number: "elbow.position" is position[1]."""
        match self.paths[column]:
            case (str(field), int(number)) if field in self.named and number < len(self.elements):
                return f"{self.elements[number]}.{field}"
        return ""

    def placed(self, message: Any) -> Callable[[FieldPath], FieldPath]:
        """Where paths lie in a message, which may name elements in its own order, or fewer."""
        names = element_names(message) if self.elements else ()
        if not names or names == self.elements:
            return lambda path: path
        at = {name: number for number, name in enumerate(names)}

        def moved(path: FieldPath) -> FieldPath:
            match path:
                case (str(field), int(number)) if field in self.named:
                    return field, at.get(self.elements[number], MANY)
            return path

        return moved


class McapLog(Log):
    """Times are seconds since the first message was logged, exact to a nanosecond in a day."""

    def __init__(self, path: Path, limits: Limits | None = None) -> None:
        self._channels: dict[int, Channel] = {}
        self._schemas: dict[int, Schema] = {}
        self._counts: dict[int, int] = {}
        self._chunks: list[ChunkIndex] = []
        self._topics: dict[str, _Topic] = {}
        self.origin = 0
        super().__init__(path, "MCAP", [], limits)
        with path.open("rb") as stream:
            self._survey(stream)
        factories = (Ros2Factory(), ProtobufFactory())
        self.tables = tuple(self._table(c, factories) for c in self._channels.values())
        if not any(self._counts.values()):
            came = "; ".join(["0 messages", *self.faults])
            raise InvalidInputError(path.name, came, "an MCAP file with messages")
        self.form = f"MCAP, times from {self.origin} ns on"

    def blocks(self, table: str, columns: Sequence[str]) -> Iterator[Block]:
        """Messages of a topic in the file's order."""
        self.table(table)
        topic = self._topics[table]
        indexed = bool(self._chunks) and all(c.message_index_offsets for c in self._chunks)
        if list(columns) == [LOG] and indexed:
            yield {LOG: self._indexed_times(topic.id)}
            return
        rows: list[list[float]] = []
        for message in self._messages(topic.id):
            row = self._row(topic, message, columns)
            if row is not None:
                rows.append(row)
            if len(rows) == ROWS:
                yield _block(rows, columns)
                rows = []
        if rows:
            yield _block(rows, columns)

    def known_ranges(self, table: str) -> KnownRanges | None:
        """Of the first messages, where a topic has too many to decode them all for a look."""
        topic = self._topics[table]
        if self._counts.get(topic.id, 0) < MANY or not self._chunks:
            return None
        names = list(topic.paths)
        block = next(self.blocks(table, names), {})
        found = {}
        for name, values in block.items():
            good = values[:SAMPLED][np.isfinite(values[:SAMPLED])]
            if len(good):
                found[name] = Extremes(float(good.min()), float(good.max()))
        return KnownRanges(f"first {SAMPLED} messages", found)

    def _survey(self, stream: IO[bytes]) -> None:
        """Channels and counts: from the summary at the end, else by reading all there is."""
        try:
            records = list(summary_in(stream))
        except Exception:  # as below
            records = []
        chunks = [r for r in records if isinstance(r, ChunkIndex)]
        statistics = [r for r in records if isinstance(r, Statistics)]
        if chunks and statistics:
            self._note(records)
            self._chunks = sorted(chunks, key=lambda c: c.chunk_start_offset)
            self._counts = statistics[-1].channel_message_counts
            self.origin = statistics[-1].message_start_time
            return
        first = None
        for message in self._linear(stream):
            self._counts[message.channel_id] = self._counts.get(message.channel_id, 0) + 1
            first = message.log_time if first is None else min(first, message.log_time)
        self.origin = first or 0

    def _linear(self, stream: IO[bytes]) -> Iterator[Message]:
        """Messages up to the end or to the first damage."""
        stream.seek(0)
        size = 0
        try:
            for record in StreamReader(stream, emit_chunks=True).records:
                inside: Iterator[McapRecord] = iter([record])
                if isinstance(record, Chunk):
                    content = self._unfolded(record, size)
                    size += len(content)
                    inside = records_in(content)
                for one in inside:
                    self._note([one])
                    if isinstance(one, Message):
                        yield one
        except VesTwinError:
            raise
        except Exception as error:  # each compression raises its own
            words = one_line(error).removeprefix("EndOfFile")
            self.note_fault("cut", f"cut or damaged; messages up to there are kept: {words}")

    def _unfolded(self, chunk: Chunk, before: int) -> bytes:
        """What a chunk holds, behind others that hold so many bytes."""
        content = unfold(chunk, self.limits.most(self.path) - before)
        self.limits.check_unfolded(self.path, before + len(content))
        return content

    def _note(self, records: Sequence[McapRecord]) -> None:
        for record in records:
            if isinstance(record, Channel):
                self._channels[record.id] = record
            elif isinstance(record, Schema):
                self._schemas[record.id] = record

    def _messages(self, channel: int) -> Iterator[Message]:
        with self.path.open("rb") as stream:
            if not self._chunks:
                yield from (m for m in self._linear(stream) if m.channel_id == channel)
                return
            size = 0
            for number, index in enumerate(self._chunks, 1):
                offsets = index.message_index_offsets
                if offsets and channel not in offsets:
                    continue
                try:
                    stream.seek(index.chunk_start_offset + 9)
                    content = self._unfolded(Chunk.read(ReadDataStream(stream)), size)
                    size += len(content)
                    for record in records_in(content):
                        if isinstance(record, Message) and record.channel_id == channel:
                            yield record
                except VesTwinError:
                    raise
                except Exception as error:  # each compression raises its own
                    words = f"chunk {number} of {len(self._chunks)} left out: {one_line(error)}"
                    self.note_fault(f"chunk {number}", words)

    def _indexed_times(self, channel: int) -> FloatArray:
        """Log times of a channel from the index records, no chunk decompressed."""
        parts = []
        with self.path.open("rb") as stream:
            for number, index in enumerate(self._chunks, 1):
                offset = index.message_index_offsets.get(channel)
                if offset is None:
                    continue
                try:
                    stream.seek(offset + 1)
                    (length,) = struct.unpack("<Q", stream.read(8))
                    content = stream.read(length)
                    pairs = np.frombuffer(content, np.uint64, 2 * ((length - 6) // 16), 6)
                except (struct.error, ValueError, OverflowError, MemoryError) as error:
                    words = f"index of chunk {number} is damaged: {one_line(error)}"
                    self.note_fault(f"index {number}", words)
                    continue
                parts.append((pairs[::2].astype(np.int64) - self.origin) * 1e-9)
        return np.concatenate(parts) if parts else np.zeros(0)

    def _table(self, channel: Channel, factories: Sequence[Any]) -> Table:
        schema = self._schemas.get(channel.schema_id)
        name = channel.topic
        if name in self._topics:
            name = f"{name}#{channel.id}"
        decode = self._decoder(channel, schema, factories)
        topic = _Topic(channel.id, decode, {})
        if decode is not None:
            topic = self._with_fields(topic, name)
        self._topics[name] = topic
        columns = [Column(LOG, "s"), Column(PUBLISH, "s")]
        columns += [
            Column(n, "s" if n.endswith("stamp") else "", said=topic.said(n)) for n in topic.paths
        ]
        return Table(name, tuple(columns), self._counts.get(channel.id, 0))

    def _decoder(
        self, channel: Channel, schema: Schema | None, factories: Sequence[Any]
    ) -> Callable[[bytes], Any] | None:
        encoding = channel.message_encoding
        try:
            if encoding == "json":
                return _from_json
            if encoding == "ros1" and schema is not None and schema.encoding == "ros1msg":
                return ros1_decoder(schema.name, schema.data.decode("utf-8", "replace"))
            for factory in factories:
                with redirect_stderr(StringIO()):  # where a parser prints lines that it refuses
                    decode = factory.decoder_for(encoding, schema)
                if decode is not None:
                    return decode  # type: ignore[no-any-return]
        except Exception as error:  # each decoder raises its own at a bad schema
            words = f"{channel.topic}: its schema cannot be used: {one_line(error)}"
            self.note_fault(channel.topic, words)
            return None
        kind = f"{encoding or 'no'} messages with a {schema.encoding if schema else 'missing'}"
        words = f"{channel.topic}: {kind} schema are not read, only their times"
        words += f"; read are {DECODED}"
        self.note_fault(channel.topic, words)
        return None

    def _with_fields(self, topic: _Topic, name: str) -> _Topic:
        """The topic with the columns of its first message, and of what the next ones name."""
        decoded = (self._decoded(topic, message) for message in self._messages(topic.id))
        looked = list(islice((one for one in decoded if one is not None), NAMING))
        if not looked:
            return topic
        first = looked[0]
        for path in islice(long_arrays(first), WIDEST):
            words = f"{name}.{path_name(path)}: a long array, left out"
            self.note_fault(f"{name} {path}", words)
        elements, named = all_elements(looked)
        paths = {path_name(p): p for p in islice(number_paths(first), WIDEST + 1)}
        paths |= {path_name((f, n)): (f, n) for f in sorted(named) for n in range(len(elements))}
        if len(paths) > WIDEST:
            words = f"{name}: more than {WIDEST} numbers a message, left out"
            self.note_fault(f"{name} numbers", words)
            paths = {}
        return _Topic(topic.id, topic.decode, paths, elements, named)

    def _decoded(self, topic: _Topic, message: Message) -> Any:
        if topic.decode is None:
            return None
        weight = JSON_WEIGHT if topic.decode is _from_json else 1
        self.limits.check_message(self.path, weight * len(message.data))
        try:
            return topic.decode(message.data)
        except Exception as error:  # each decoder raises its own
            name = self._channels[topic.id].topic
            words = f"{name}: messages that cannot be decoded were left out: {one_line(error)}"
            self.note_fault(f"{name} messages", words)
            return None

    def _row(self, topic: _Topic, message: Message, columns: Sequence[str]) -> list[float] | None:
        times = {LOG: message.log_time, PUBLISH: message.publish_time}
        decoded = None
        if any(column not in times for column in columns):
            decoded = self._decoded(topic, message)
            if decoded is None:
                return None
        placed = topic.placed(decoded)
        return [
            (times[c] - self.origin) * 1e-9
            if c in times
            else number_at(decoded, placed(topic.paths[c]), self.origin)
            for c in columns
        ]


def _from_json(data: bytes) -> Any:
    return json.loads(data)


def _block(rows: list[list[float]], columns: Sequence[str]) -> Block:
    table = np.array(rows, dtype=np.float64)
    return {name: table[:, i] for i, name in enumerate(columns)}
