"""compare: where measured recordings and the simulation part; one page, one JSON file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.machines.ves2.compare import Named
    from ves_twin.machines.ves2.comparison_result import Comparison

from ves_twin.cli.exit_codes import DONE, OUT_OF_TOLERANCE
from ves_twin.cli.rig_recordings import add_rig_arguments, means_rig

SUMMARY = "show where measured recordings and the simulation part"
JSON_NAME, PAGE_NAME = "compare.json", "report.html"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "recordings", metavar="MEASURED", nargs="+", help="recording files, or folders of runs"
    )
    parser.add_argument(
        "--against", metavar="REC", help="hold them against this recording, not the plant"
    )
    parser.add_argument("--experiment", metavar="FILE", help="how they were made (TOML)")
    parser.add_argument("--plant", metavar="FILE", help="another plant, or a rig: name or TOML")
    add_rig_arguments(parser, alternate=False)
    parser.add_argument("--tolerance", metavar="FILE", help="limits in SI (TOML), exit 4 if broken")
    parser.add_argument("--standstill", metavar="REC", help="noise from this recording at rest")
    parser.add_argument("--out", metavar="DIR", help="output folder (default: runs/compare)")
    parser.add_argument("--json", action="store_true", help="the result as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Compare, write page and JSON, print the answer."""
    if means_rig(arguments):
        return _rig(arguments)
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.rig_recordings import refuse_rig_options
    from ves_twin.report.comparison.page import comparison_page
    from ves_twin.report.page import write_page
    from ves_twin.simulator.simulate import make_folder

    refuse_rig_options(arguments)
    comparison = _compare(arguments)
    folder = output_folder(arguments.out, "compare")
    page = comparison_page(comparison)
    text = json_text(comparison.to_dict())
    make_folder(folder)
    write_page(folder / JSON_NAME, text + "\n")
    write_page(folder / PAGE_NAME, page)
    print(text if arguments.json else _text(comparison, folder))
    return OUT_OF_TOLERANCE if comparison.in_tolerance is False else DONE


def _rig(arguments: argparse.Namespace) -> int:
    """A rig of two files: its own mode, and closed loop where it has controllers."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.rig_recordings import rig_recordings
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.machines.mjcf.compare_mjcf import SCHEMA, compare_mjcf
    from ves_twin.report.comparison.mjcf_page import comparison_lines, rig_comparison_page
    from ves_twin.report.page import write_page
    from ves_twin.simulator.simulate import make_folder

    for option in ("against", "tolerance", "standstill"):
        if getattr(arguments, option):
            raise InvalidInputError(f"--{option}", "a rig", "a plant of VES II beside it")
    given = rig_recordings(arguments, arguments.recordings, alike=False)
    pairs = zip(given.measured, given.rigs, strict=True)
    found = [one for recording, rig in pairs for one in compare_mjcf([recording], rig)]
    content = {"schema": SCHEMA, "recordings": [one.to_dict() for one in found]}
    text = json_text(content)
    folder = output_folder(arguments.out, "compare")
    page = rig_comparison_page(found)
    make_folder(folder)
    write_page(folder / JSON_NAME, text + "\n")
    write_page(folder / PAGE_NAME, page)
    files = f"files {folder}/{PAGE_NAME}, {JSON_NAME}"
    print(text if arguments.json else "\n".join([*comparison_lines(found), files]))
    return 0


def _compare(arguments: argparse.Namespace) -> Comparison:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.machines.ves2.compare import compare
    from ves_twin.machines.ves2.tolerance import Tolerance
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.experiment import Experiment

    given = arguments.experiment
    experiment = Experiment.load(given) if given else Experiment()
    if arguments.standstill:
        everyone = {"noise": arguments.standstill}
        own = {n: d.model_copy(update=everyone) for n, d in experiment.recordings.items()}
        experiment = experiment.model_copy(update={**everyone, "recordings": own})
    tolerance = Tolerance.load(arguments.tolerance) if arguments.tolerance else None
    plant = Plant.load(arguments.plant) if arguments.plant else None
    recordings = [_named(path) for path in arguments.recordings]
    against = _named(arguments.against) if arguments.against else None
    with RunProgress("compare", 1.0, unit="share") as progress:
        return compare(recordings, plant, experiment, tolerance, against, progress.share)


def _named(path: str) -> Named:
    from ves_twin.core.recording.files import load_recording, recording_name
    from ves_twin.machines.ves2.compare import Named

    return Named(recording_name(path), load_recording(path))


def _text(comparison: Comparison, folder: Path) -> str:
    from ves_twin.data.quality.check import Grade
    from ves_twin.report.comparison.words import (
        cost_sentence,
        gap_sentence,
        place_sentence,
        tolerance_sentence,
        trust_sentence,
    )

    lines = []
    for r in comparison.recordings:
        lines += [f"{r.name}: plant {r.plant} {r.plant_hash}, against the {r.basis.value}"]
        lines += [f"  {trust_sentence(r)}"]
        lines += [f"    {c.name}: {c.message}" for c in r.checks if c.grade is Grade.FAILED]
        lines += [f"  {gap_sentence(r)}"]
        lines += [f"    {place_sentence(c)}" for c in r.beyond_noise[:4]]
        lines += [f"  {cost_sentence(r)}"] if r.cost else []
        lines += [f"  Not compared: {', '.join(r.absent)}"] if r.absent else []
        lines += [f"  Note: {note}" for note in r.notes]
    lines += [tolerance_sentence(comparison), f"files {folder}/{PAGE_NAME}, {JSON_NAME}"]
    return "\n".join(lines)
