"""inspect: what is in a lab file: channels, units, rates, ranges, gaps; a map to edit."""

from __future__ import annotations

import argparse
from pathlib import Path

from ves_twin.cli.limit import add_limit
from ves_twin.core.json_text import json_text

SUMMARY = "show what is in a lab file: channels, rates, ranges, gaps; draft a map"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("file", metavar="FILE", help="CSV, Parquet, Arrow, MAT, npz or MCAP")
    parser.add_argument(
        "--draft-map", action="store_true", help="write a map to edit (default: NAME.map.toml here)"
    )
    parser.add_argument("--out", metavar="MAP", help="where the map goes")
    add_limit(parser)
    parser.add_argument("--json", action="store_true", help="the content as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Read the file once, print what is in it, write the map if one is asked for."""
    from ves_twin.core.held_folder import hold_file
    from ves_twin.data.draft_map import draft_map
    from ves_twin.data.formats.limits import Limits
    from ves_twin.data.formats.open_log import open_log
    from ves_twin.data.inspect_log import inspect_log
    from ves_twin.data.inspection_text import inspection_text
    from ves_twin.report.page import write_page

    inspection = inspect_log(open_log(arguments.file, Limits.of(arguments.limit)))
    content, text = inspection.to_dict(), inspection_text(inspection)
    if arguments.draft_map or arguments.out:
        path = _place(arguments.out, Path(arguments.file))
        with hold_file(path):
            write_page(path, draft_map(inspection))
        content["map"], text = str(path), f"{text}\n\nmap to edit: {path}"
    print(json_text(content) if arguments.json else text)
    return 0


def _place(given: str | None, file: Path) -> Path:
    """The place asked for, or the next free NAME.map.toml: an edited map is never overwritten."""
    if given is not None:
        return Path(given)
    path, number = Path(f"{file.stem}.map.toml"), 1
    while path.exists():
        number += 1
        path = Path(f"{file.stem}.map-{number}.toml")
    return path
