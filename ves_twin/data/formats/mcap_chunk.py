"""unfold, records_in and summary_in: parts of an MCAP file, no further than their limits.

The usual reader unfolds a chunk to whatever it holds, also the chunks of a summary.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator
from contextlib import suppress
from io import BytesIO
from typing import IO

import lz4.frame
import zstandard
from mcap.exceptions import EndOfFile, UnsupportedCompressionError
from mcap.records import Chunk, Footer, McapRecord
from mcap.stream_reader import MAGIC_SIZE, CRCValidationError, StreamReader

FOOTER_SIZE = 29
"""Opcode, length, two offsets and a sum (MCAP specification, footer)."""


def unfold(chunk: Chunk, most: int) -> bytes:
    """What a chunk holds; one byte more than `most` where it holds more than that.

    Raises:
        ValueError: it holds more than it says, or something else than its sum says.
        Exception: of the library that unfolds it, at damaged data.
    """
    if not chunk.compression:
        content = chunk.data
    elif chunk.compression == "zstd":
        with zstandard.ZstdDecompressor().stream_reader(chunk.data) as stream:
            content = stream.read(min(chunk.uncompressed_size, most) + 1)
    elif chunk.compression == "lz4":
        reader = lz4.frame.LZ4FrameDecompressor()
        content = reader.decompress(chunk.data, min(chunk.uncompressed_size, most) + 1)
    else:
        raise UnsupportedCompressionError(chunk.compression)
    if len(content) > most:
        return content
    if len(content) != chunk.uncompressed_size:
        raise ValueError(f"{len(content)} bytes where it says {chunk.uncompressed_size}")
    found = zlib.crc32(content)
    if chunk.uncompressed_crc not in (0, found):
        raise CRCValidationError(chunk.uncompressed_crc, found, chunk)
    return content


def records_in(content: bytes) -> Iterator[McapRecord]:
    """Records of an unfolded chunk, one at a time."""
    with suppress(EndOfFile):
        yield from StreamReader(BytesIO(content), skip_magic=True, emit_chunks=True).records


def summary_in(stream: IO[bytes]) -> Iterator[McapRecord]:
    """Records of the summary at the end of a file; none if it has none."""
    stream.seek(-FOOTER_SIZE - MAGIC_SIZE, os.SEEK_END)
    footer = next(StreamReader(stream, skip_magic=True).records)
    if isinstance(footer, Footer) and footer.summary_start:
        stream.seek(footer.summary_start)
        yield from StreamReader(stream, skip_magic=True, emit_chunks=True).records
