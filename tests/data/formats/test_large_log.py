"""A ten-minute log of 30 channels at 1 kHz stays within memory."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv as pcsv
import pytest

ROWS, CHANNELS = 600_000, 30
LIMIT = 2000.0
"""Peak memory that an import may take [MiB]: 2 GB."""
LOOK = 500.0
"""Peak memory that a look may take [MiB]."""

RUN = """
import sys
from pathlib import Path
from ves_twin.cli.main import main
assert main(sys.argv[1:]) == 0
words = Path("/proc/self/status").read_text().split()
print(int(words[words.index("VmHWM:") + 1]) / 1024, file=sys.stderr)
"""
"""VmHWM is the process's own; ru_maxrss counts what the parent had when it started this one."""


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    folder = tmp_path_factory.mktemp("large")
    t = np.arange(ROWS) / 1e3
    columns = {"t [s]": t}
    columns |= {f"x{i} [mm]": np.round(1000.0 + np.sin(t + i), 4) for i in range(CHANNELS)}
    pcsv.write_csv(pa.table(columns), folder / "log.csv")
    lines = ['schema = 1\nrate = "100 Hz"\n[clock]\ncolumn = "t [s]"\n[signals."x"]\nunit = "m"']
    lines += [f'[[channel]]\nfrom = "x{i} [mm]"\nto = "x.{i + 1}"' for i in range(CHANNELS)]
    (folder / "map.toml").write_text("\n".join(lines) + "\n")
    return folder


def peak(*words):
    """Peak memory [MiB] of a command in a process of its own, and what it printed."""
    command = [sys.executable, "-c", RUN, *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stderr.splitlines()[-1]), json.loads(done.stdout)


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="peak memory is read from /proc")
def test_ten_minutes_at_1_khz_are_inspected_and_imported_within_memory(log):
    memory, seen = peak("inspect", log / "log.csv", "--json")
    assert memory < LOOK
    assert seen["tables"][0]["rows"] == ROWS
    assert len(seen["tables"][0]["channels"]) == CHANNELS
    words = ("--map", log / "map.toml", "--out", log / "rec.parquet", "--json")
    memory, account = peak("import", log / "log.csv", *words)
    assert memory < LIMIT
    assert account["rows"] == ROWS // 10
