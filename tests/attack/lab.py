"""LAB: lab files of every kind that is read, drawn from grammars of what they may hold."""

from __future__ import annotations

import gzip
import io
import json
import random
import struct
import zipfile
from collections.abc import Callable
from datetime import time
from decimal import Decimal
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import scipy.io
from mcap.writer import CompressionType, Writer

ROWS = (0, 1, 2, 3, 40, 300)
NAMES = ("t", "t [s]", "time", "stamp", "x", "x", "leg.length.1", "L1 [mm]", "", "é", "a.b", "x.2")
CELLS = ("", "nan", "-", "OVL", "1e400", "-1e-400", "0x1F", "1,5", '"1"', "2024-13-45 99:99", "\0",
         "\x1b[31m", "é", "9" * 400, "1;2", "--5", "inf", "2024-05-01T12:00:00Z", " ")  # fmt: skip


def csv(chance: random.Random) -> bytes:
    separator = chance.choice((",", ";", "\t", "|", "  ", ", "))
    width, end = chance.choice((1, 2, 3, 8, 200)), chance.choice(("\n", "\n", "\r\n", "\r"))
    lines = [f"# {chance.choice(CELLS)}" for _ in range(chance.choice((0, 0, 1, 5)))]
    if chance.random() < 0.8:
        lines.append(separator.join(chance.choice(NAMES) for _ in range(width)))
    if chance.random() < 0.2:
        lines.append(
            separator.join(chance.choice(("s", "[mm]", "deg", "", "x")) for _ in range(width))
        )
    bad = chance.choice((0.0, 0.0, 0.01, 0.2))
    for i in range(chance.choice(ROWS)):
        row = [f"{0.01 * i:.2f}", *(f"{chance.gauss(0, 1):.6g}" for _ in range(width - 1))]
        row = [chance.choice(CELLS) if chance.random() < bad else cell for cell in row]
        if chance.random() < 0.3 * bad:
            row = row[: chance.randrange(width + 1)] + row[:1] * chance.randrange(3)
        text = separator.join(row)
        lines.append(text.replace(".", ",") if separator == ";" else text)
    if chance.random() < 0.02:
        lines.append("7" * chance.choice((10**5, 10**7)))
    content = end.join(lines).encode("utf-8" if chance.random() < 0.8 else "utf-16-le", "replace")
    return content if chance.random() < 0.7 else content.replace(b"\xc3", b"\xff")


def packed_csv(chance: random.Random) -> bytes:
    content = csv(chance)
    if chance.random() < 0.02:
        content = b"t,x\n0,1\n1,2\n" + chance.choice((b"1", b"0.1,2\n")) * (4 * 10**7)
    return gzip.compress(content, 1)


def table(chance: random.Random) -> pa.Table:
    rows = chance.choice(ROWS)
    columns = [_column(chance, rows) for _ in range(chance.choice((0, 1, 2, 5)))]
    names = [chance.choice(NAMES) for _ in columns]
    return pa.Table.from_arrays(columns, names=names)


def _column(chance: random.Random, rows: int) -> pa.Array:
    plain = pa.array(np.sort(np.random.default_rng(chance.randrange(99)).normal(0, 50, rows)))
    whole = plain.cast(pa.int64(), safe=False)
    kinds: list[Callable[[], pa.Array]] = [
        lambda: plain, lambda: plain, lambda: whole,
        lambda: plain.cast(pa.float16()), lambda: plain.cast(pa.float32()),
        lambda: pa.array([i % 100 for i in range(rows)], pa.int8()), lambda: whole.cast(pa.int32()).cast(pa.date32()),
        lambda: whole.cast(pa.timestamp(chance.choice(("s", "ms", "us", "ns")))),
        lambda: pa.array([2**62 + i for i in range(rows)], pa.timestamp("us", tz="UTC")),
        lambda: whole.cast(pa.duration(chance.choice(("s", "ns")))),
        lambda: pa.array([time(i // 3600 % 24, i // 60 % 60, i % 60) for i in range(rows)]),
        lambda: pa.array([Decimal(i) / 7 for i in range(rows)], pa.decimal128(30, 10), safe=False)
        if not rows else pa.array([Decimal(i) for i in range(rows)], pa.decimal128(30, 10)),
        lambda: pa.array([str(i) for i in range(rows)]),
        lambda: pa.array([str(i % 3) for i in range(rows)]).dictionary_encode(),
        lambda: plain.dictionary_encode(), lambda: pa.nulls(rows),
        lambda: pa.array([b"\xff" * (i % 5) for i in range(rows)]),
        lambda: pa.array([[1.0] * (i % 4) for i in range(rows)], pa.list_(pa.float64())),
        lambda: pa.array([{"a": i, "x": [i % 100]} for i in range(rows)], pa.struct(
            {"a": pa.int64(), "x": pa.list_(pa.int8())})),
        lambda: pa.array([[("k", i)] for i in range(rows)], pa.map_(pa.string(), pa.int64())),
        lambda: pa.array([None if i % 3 else 1.5 for i in range(rows)], pa.float64()),
        lambda: pa.array([i % 2 == 0 for i in range(rows)], pa.bool_()),
        lambda: pa.array([2**64 - 1] * rows, pa.uint64()),
    ]  # fmt: skip
    return chance.choice(kinds)()


def parquet(chance: random.Random) -> bytes:
    def write(path: Path) -> None:
        pq.write_table(
            table(chance), path, compression=chance.choice(("none", "zstd", "snappy", "gzip")),
            row_group_size=chance.choice((7, 1000)), use_dictionary=chance.random() < 0.5,
            write_statistics=chance.random() < 0.7,
        )  # fmt: skip

    return _written(write)


def arrow(chance: random.Random) -> bytes:
    content = table(chance)
    if chance.random() < 0.5:
        pack = chance.choice(("lz4", "zstd", "uncompressed"))
        return _written(lambda path: feather.write_feather(content, path, compression=pack))
    sink = io.BytesIO()
    with pa.ipc.new_stream(sink, content.schema) as writer:
        writer.write_table(content, max_chunksize=chance.choice((1, 50)))
    return sink.getvalue()


def _array(chance: random.Random) -> np.ndarray:
    shape = chance.choice(((), (1,), (300,), (300, 3), (3, 300), (2, 2, 2), (0,), (5, 0), (300, 1)))
    kind = chance.choice(
        ("f8", "f4", "f2", "i1", "u8", "?", "c16", "S5", "U3", "M8[s]", ">f8", "V4")
    )
    if chance.random() < 0.05:
        return np.array([{"a": 1}, None], dtype=object)
    if chance.random() < 0.1:
        return np.zeros(max(shape or (1,)), [("t", "f8"), ("x y", "i4"), ("é", "f4", (2,))])
    values = np.arange(int(np.prod(shape)), dtype=float).reshape(shape)
    return values.astype("f8").astype(kind) if kind not in ("V4",) else np.zeros(shape, kind)


def npz(chance: random.Random) -> bytes:
    names = ("t", "x", "y", "units", "a/b", "..", "é")
    sink = io.BytesIO()
    if chance.random() < 0.05:
        return _npy_bomb(chance)
    if chance.random() < 0.3:
        np.save(sink, _array(chance), allow_pickle=True)
    else:
        save = chance.choice((np.savez, np.savez_compressed))
        save(sink, **{chance.choice(names): _array(chance) for _ in range(chance.randrange(5))})
    return sink.getvalue()


def _npy_bomb(chance: random.Random) -> bytes:
    """A header that claims much, and zeros that unfold to much."""
    count = chance.choice((10**7, 10**9, 10**15, -1))
    kind = {"descr": chance.choice(("<f8", "|i1")), "fortran_order": False, "shape": (count,)}
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, kind)
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("t.npy", head.getvalue() + bytes(chance.choice((0, 10**6, 10**8))))
    return sink.getvalue()


def mat(chance: random.Random) -> bytes:
    def one(depth: int) -> object:
        draw = chance.random()
        if draw < 0.5 or depth > 2:
            return np.nan_to_num(np.random.default_rng(1).normal(size=chance.choice(((300, 1), (1, 300),
                                 (300, 3), (1, 1), (0, 0), (2, 2, 2)))))  # fmt: skip
        if draw < 0.65:
            return {chance.choice("abct"): one(depth + 1) for _ in range(chance.randrange(1, 3))}
        if draw < 0.75:
            cells = np.empty(chance.randrange(1, 4), dtype=object)
            cells[:] = [one(depth + 1) for _ in cells]
            return cells
        return chance.choice(("text", 1.5, np.arange(300), np.ones(300) * 1j, scipy.sparse.eye(3)))

    sink = io.BytesIO()
    form = chance.choice(("5", "5", "4"))
    content = {
        name: one(0) if form == "5" else np.arange(300.0) for name in chance.sample("txyz", 2)
    }
    scipy.io.savemat(
        sink, content, format=form, do_compression=form == "5" and chance.random() < 0.5
    )
    return sink.getvalue()


ROS = ("float64 x", "int32[4] y", "string s", "time stamp", "Header header", "B[] more", "B[3] few",
       "float64[] many", "uint8[<=5] bytes", "float64 2x", "int8 C=3", "bool b", "wstring w")  # fmt: skip


def mcap(chance: random.Random) -> bytes:
    sink = io.BytesIO()
    pack = chance.choice(list(CompressionType))
    writer = Writer(
        sink, chunk_size=chance.choice((100, 4000, 10**6)), compression=pack,
        use_chunking=chance.random() < 0.8, use_statistics=chance.random() < 0.8,
        use_summary_offsets=chance.random() < 0.8, enable_crcs=chance.random() < 0.8,
    )  # fmt: skip
    writer.start()
    for topic in range(chance.choice((0, 1, 3))):
        encoding, kind = chance.choice((("json", "jsonschema"), ("ros1", "ros1msg"), ("cdr", "ros2msg"),
                                        ("protobuf", "protobuf"), ("", ""), ("cdr", "ros2idl")))  # fmt: skip
        lines = chance.sample(ROS, chance.randrange(1, 4))
        text = "\n".join([*lines, "=" * 80, "MSG: a/B", *chance.sample(ROS, chance.randrange(3))])
        schema = writer.register_schema(
            "a/msg/A" if kind == "ros2msg" else "a/A", kind, text.encode()
        )
        channel = writer.register_channel(chance.choice(("/a", "/b", "")), encoding, schema)
        for i in range(chance.choice(ROWS)):
            data = (
                _json(chance, i)
                if encoding == "json"
                else chance.randbytes(chance.choice((0, 8, 60)))
            )
            writer.add_message(channel, chance.choice((i * 10**7, i, 2**63)), data, topic)
    if chance.random() < 0.01:  # near the limit of a message, and all of it lists
        channel = writer.register_channel("/c", "json", writer.register_schema("c", "", b""))
        writer.add_message(channel, 0, b"[" + b"[]," * 10**7 + b"0]", 0)
    writer.finish()
    return sink.getvalue()


def _json(chance: random.Random, i: int) -> bytes:
    if chance.random() < 0.02:
        return chance.choice((b"[" * 10**5, b'{"x":' * 1000, b"9" * 5000, b"NaN", b'"\xff"', b"{"))
    message = {"x": 0.1 * i, "y": [i] * chance.choice((0, 3, 100)), "s": "a", "n": None,
               "stamp": {"sec": i, "nanosec": chance.choice((5, -1, 1e300, "a", 10**30))}}  # fmt: skip
    return json.dumps(message).encode()


def rubbish(chance: random.Random) -> bytes:
    """The first bytes of a known kind, then anything."""
    heads = (b"\x89MCAP0\r\n", b"PAR1", b"ARROW1\0\0", b"\xff\xff\xff\xff", b"MATLAB 5.0", b"PK\x03\x04",
             b"\x93NUMPY\x01\0", b"\x89HDF\r\n\x1a\n", b"#ROSBAG", b"\x80\x04", b"")  # fmt: skip
    size = struct.pack("<I", chance.choice((0, 118, 2**31)))
    return chance.choice(heads) + size + chance.randbytes(chance.choice((0, 4, 200, 5000)))


def _written(write: Callable[[Path], None]) -> bytes:
    with TemporaryDirectory() as folder:
        write(Path(folder) / "file")
        return (Path(folder) / "file").read_bytes()


LAB = {
    "lab.csv": csv, "lab.csv.gz": packed_csv, "lab.parquet": parquet, "lab.arrow": arrow,
    "lab.npz": npz, "lab.mat": mat, "lab.mcap": mcap, "lab.bin": rubbish,
}  # fmt: skip
