"""compare: where measured recordings and the simulation part; one page, one JSON file."""

from __future__ import annotations

import argparse
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.machines.comparison import Comparison

from ves_twin.cli.exit_codes import DONE, OUT_OF_TOLERANCE
from ves_twin.cli.given import Given, add_machine_options

SUMMARY = "show where measured recordings and the simulation part"
JSON_NAME, PAGE_NAME = "compare.json", "report.html"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "recordings", metavar="MEASURED", nargs="+", help="recording files, or folders of runs"
    )
    parser.add_argument(
        "--against", metavar="REC", help="hold them against this recording, not the machine"
    )
    add_machine_options(parser)
    parser.add_argument("--tolerance", metavar="FILE", help="limits in SI (TOML), exit 4 if broken")
    parser.add_argument(
        "--envelope",
        action="store_true",
        help="draw where a machine in order may lie, however long that takes (default: where it"
        " takes half a minute at most)",
    )
    parser.add_argument("--out", metavar="DIR", help="output folder (default: runs/compare)")
    parser.add_argument("--json", action="store_true", help="the result as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Compare, write page and JSON, print the answer."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.report.comparison.page import comparison_page
    from ves_twin.report.page import write_page

    with output_folder(arguments.out, "compare") as held:
        comparison = _compare(arguments)
        text = json_text(comparison.to_dict())
        write_page(held.path / JSON_NAME, text + "\n")
        write_page(held.path / PAGE_NAME, comparison_page(comparison))
    print(text if arguments.json else _text(comparison, held.path))
    return OUT_OF_TOLERANCE if comparison.in_tolerance is False else DONE


def _compare(arguments: argparse.Namespace) -> Comparison:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.machines.compare import PATIENCE, compare
    from ves_twin.machines.tolerance import Tolerance

    given = Given.of(arguments)
    tolerance = None
    if arguments.tolerance:
        tolerance = Tolerance.load(arguments.tolerance, given.machine.signals)
    recordings = given.read(arguments.recordings)
    against = given.read([arguments.against])[0] if arguments.against else None
    with RunProgress("compare", 1.0, unit="share") as progress:
        return compare(
            recordings,
            given.machine,
            experiment=given.experiment,
            tolerance=tolerance,
            against=against,
            standstill=given.standstill(arguments.standstill),
            progress=progress.share,
            patience=inf if arguments.envelope else PATIENCE,
        )


def _text(comparison: Comparison, folder: Path) -> str:
    from ves_twin.data.quality.check import Grade
    from ves_twin.report.comparison.words import (
        cost_sentence,
        envelope_sentence,
        fed_words,
        gap_sentence,
        place_sentence,
        rests_on,
        tolerance_sentence,
        trust_sentence,
    )

    lines = []
    for r in comparison.recordings:
        lines += [f"{r.name}: plant {r.plant} {r.plant_hash}, against the {r.basis.value}"]
        lines += [f"  Fed in: {fed_words(r)}"]
        lines += [f"  {trust_sentence(r)}"]
        lines += [f"    {c.name}: {c.message}" for c in r.checks if c.grade is Grade.FAILED]
        lines += [f"  {gap_sentence(r)}"]
        lines += [f"  {envelope_sentence(r)}"] if r.outside else []
        lines += [f"    {place_sentence(c)}" for c in r.beyond_noise[:4]]
        lines += [f"  {cost_sentence(r)}"] if r.cost else []
        lines += [f"  Rests on: {rests_on(r)}"]
        lines += [f"  Not compared: {', '.join(r.absent)}"] if r.absent else []
        lines += [f"  Note: {note}" for note in r.notes[1:]]
    lines += [tolerance_sentence(comparison), f"files {folder}/{PAGE_NAME}, {JSON_NAME}"]
    return "\n".join(lines)
