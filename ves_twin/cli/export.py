"""export: a recording as CSV, Parquet or MAT for other programs."""

from __future__ import annotations

import argparse
from pathlib import Path

SUMMARY = "write a recording as CSV, Parquet or MAT"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("recording", metavar="REC", help="a recording, or the folder of a run")
    parser.add_argument("--format", metavar="FORMAT", help="csv, parquet, mat (default: by name)")
    parser.add_argument("--out", metavar="FILE", required=True, help="the file to write")


def execute(arguments: argparse.Namespace) -> int:
    """Write the file."""
    from ves_twin.core.held_folder import hold_file
    from ves_twin.core.recording.files import load_recording
    from ves_twin.data.export import export_recording

    path = Path(arguments.out)
    form = arguments.format or path.suffix.removeprefix(".")
    with hold_file(path):
        recording = load_recording(arguments.recording)
        files = export_recording(recording, form, path)
    print(f"{len(recording)} rows in {', '.join(map(str, files))}")
    return 0
