"""Import of a 10-minute log of 30 channels at 1 kHz, and a look into files of 1 GB.

Run by `make bench`. Each figure is a command in a process of its own: wall time, processor time and
peak memory as the operating system counted them. Files are written to a folder that is removed.
"""

from __future__ import annotations

import argparse
import base64
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pcsv
import pyarrow.parquet as pq

CHANNELS, RATE, PIECE = 30, 1000.0, 100_000
NAMES = ["Time [s]", *(f"ch{i + 1} [mm]" for i in range(CHANNELS))]

MEASURED = """
import json, resource, sys, time
from pathlib import Path
begin = time.perf_counter()
from ves_twin.cli.main import main
code = main(sys.argv[1:])
used = resource.getrusage(resource.RUSAGE_SELF)
words = Path("/proc/self/status").read_text().split()  # ru_maxrss would count the parent's
peak = int(words[words.index("VmHWM:") + 1]) / 1024
figures = [code, time.perf_counter() - begin, used.ru_utime + used.ru_stime, peak]
print(json.dumps(figures), file=sys.stderr)
"""


def tables(rows: int) -> Iterator[pa.Table]:
    """A log in pieces: motion of some hertz with noise, five decimals."""
    rng = np.random.default_rng(0)
    for first in range(0, rows, PIECE):
        t = np.round(np.arange(first, min(first + PIECE, rows)) / RATE, 3)
        columns = [
            np.round(1000.0 + 50.0 * np.sin(2.0 * t + i) + rng.normal(size=len(t)), 5)
            for i in range(CHANNELS)
        ]
        yield pa.table([t, *columns], names=NAMES)


def write_csv(path: Path, rows: int) -> None:
    with path.open("wb") as file:
        file.write((",".join(NAMES) + "\n").encode())
        for table in tables(rows):
            pcsv.write_csv(table, file, pcsv.WriteOptions(include_header=False))


def write_parquet(path: Path, rows: int) -> None:
    pieces = tables(rows)
    first = next(pieces)
    with pq.ParquetWriter(path, first.schema, compression="zstd") as writer:
        writer.write_table(first)
        for table in pieces:
            writer.write_table(table)


def write_mcap(path: Path, messages: int) -> None:
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("log", "jsonschema", b"{}")
        topics = [writer.register_channel(f"/node{k}", "json", schema) for k in range(5)]
        for i in range(messages):
            at, pad = i * 1_000_000, base64.b64encode(os.urandom(8000)).decode()  # no compression
            data = json.dumps({"q": [np.sin(0.001 * i), float(i)], "note": pad}).encode()
            writer.add_message(topics[i % 5], at, data, at)
        writer.finish()


def figures(words: list[str]) -> tuple[float, float, float]:
    """Wall [s], processor [s], peak memory [MiB] of a command."""
    command = [sys.executable, "-c", MEASURED, *words]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    code, *found = json.loads(done.stderr.splitlines()[-1])
    if code:
        raise RuntimeError(done.stderr)
    return tuple(found)


def map_of(path: Path, rate: str = "") -> Path:
    """A map of all channels, to 100 Hz if a rate is given."""
    lines = ["schema = 1", rate, "[clock]", 'column = "Time [s]"']
    for i in range(CHANNELS):
        lines += ["[[channel]]", f'from = "ch{i + 1} [mm]"', f'to = "bench.x.{i + 1}"']
    path.write_text("\n".join([*lines, '[signals."bench.x"]', 'unit = "m"']) + "\n")
    return path


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=float, default=1e9, help="bytes of the large files")
    size = parser.parse_args().size
    print(f"{'command':<44}{'file MB':>9}{'wall s':>8}{'cpu s':>8}{'peak MiB':>10}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = {
            "log.csv": lambda p: write_csv(p, 600_000),
            "log.parquet": lambda p: write_parquet(p, 600_000),
            "large.csv": lambda p: write_csv(p, int(size / 301)),
            "large.parquet": lambda p: write_parquet(p, int(size / 278)),
            "large.mcap": lambda p: write_mcap(p, int(size / 8200)),
        }
        same, slow = map_of(folder / "same.toml"), map_of(folder / "slow.toml", 'rate = "100 Hz"')
        for file, write in files.items():
            path = folder / file
            write(path)
            time.sleep(1.0)
            runs = [("inspect", ["inspect", str(path)])]
            if file.startswith("log"):
                out = str(folder / "rec.parquet")
                runs.append(
                    ("import, own rows", ["import", str(path), "--map", str(same), "--out", out])
                )
                runs.append(
                    ("import, to 100 Hz", ["import", str(path), "--map", str(slow), "--out", out])
                )
            for what, words in runs:
                wall, cpu, peak = figures(words)
                label, mega = f"{what}: {file}", path.stat().st_size / 1e6
                print(f"{label:<44}{mega:9.0f}{wall:8.1f}{cpu:8.1f}{peak:10.0f}", flush=True)
            path.unlink()


if __name__ == "__main__":
    main()
