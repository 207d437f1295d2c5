"""run: run a scenario, write recording, summary and rerun file, print the summary."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.control.controller import PlatformController
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.schema import Scenario
    from ves_twin.simulator.simulate import Summary

SUMMARY = "run a scenario and write its recording"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("scenario", metavar="SCENARIO", help="a name or a TOML file")
    add_run_options(parser)
    parser.add_argument("--json", action="store_true", help="the summary as JSON on stdout")
    parser.add_argument(
        "--video",
        metavar="FILE.mp4",
        help="draw the run as a moving picture (.mp4, .gif), with its time and curves",
    )


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """Options that every command that runs a scenario shares."""
    parser.add_argument(
        "--set",
        dest="settings",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="override a key of the scenario, for instance legs.gain=16; may be repeated",
    )
    parser.add_argument("--plant", metavar="FILE", help="another plant: a name or a TOML file")
    parser.add_argument("--seed", type=int, metavar="N", help="seed of the noise")
    parser.add_argument("--out", metavar="DIR", help="output folder (default: runs/SCENARIO)")
    parser.add_argument(
        "--controller",
        metavar="FILE:Class",
        help="a PlatformController of a Python file, which is run, in place of the mode's own",
    )
    parser.add_argument("--no-rrd", action="store_true", help="write no rerun file")


def execute(arguments: argparse.Namespace) -> int:
    """Run the scenario or procedure; the exit code tells how it ended."""
    from ves_twin.cli.exit_codes import exit_code
    from ves_twin.cli.run_procedure import run_procedure

    ended = run_procedure(arguments)
    if ended is not None:
        return ended
    video = None if arguments.video is None else Path(arguments.video)
    if video is not None:
        from ves_twin.envs.film import check_video

        check_video(video, load(arguments)[0].run.duration)
    with run_scenario(arguments) as (summary, folder):
        if arguments.json:
            print(summary.to_json())
        else:
            from ves_twin.cli.summary_text import summary_text

            print(summary_text(summary, folder))
        if video is not None:
            print(_draw(folder, video), file=sys.stderr if arguments.json else sys.stdout)
    return exit_code(summary.outcome)


def _draw(folder: Path, video: Path) -> str:
    """Draw a run whose summary is told, and say so; one without rows has nothing to draw."""
    from ves_twin.core.recording.files import load_recording
    from ves_twin.envs.film import write_film

    recording = load_recording(folder)
    if not len(recording):
        return f"  video     none: the run ended before its first row; {video} is not written"
    write_film(recording, video)
    return f"  video     {video}"


@contextmanager
def run_scenario(arguments: argparse.Namespace) -> Iterator[tuple[Summary, Path]]:
    """Run the scenario that the arguments name; its folder is held until the block ends."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.cli.progress import RunProgress
    from ves_twin.simulator.simulate import record

    scenario, plant = load(arguments)
    controller = load_controller(arguments)
    with output_folder(arguments.out, scenario.name) as held:
        with RunProgress(scenario.name, scenario.run.duration) as progress:
            summary = record(scenario, held, plant, arguments.seed, progress, controller)
        if not arguments.no_rrd and summary.duration > 0:
            from ves_twin.core.recording.files import load_recording
            from ves_twin.report.rerun.write import write_rrd

            write_rrd(load_recording(held.path), held.path / "run.rrd")
        yield summary, held.path


def load(arguments: argparse.Namespace) -> tuple[Scenario, Plant | None]:
    """Scenario with the overrides, and the plant given instead of the scenario's own.

    Raises:
        VesTwinError: anything in them that cannot be used.
    """
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.load import parse_setting
    from ves_twin.scenario.schema import Scenario

    changes = dict(parse_setting(text) for text in arguments.settings)
    scenario = Scenario.load(arguments.scenario, changes)
    if arguments.seed is not None and not 0 <= arguments.seed < 2**63:
        raise InvalidInputError("--seed", arguments.seed, "at least 0 and below 2^63")
    if arguments.plant is None:
        return scenario, None
    return scenario, Plant.load(arguments.plant).with_values(scenario.parameters)


def load_controller(arguments: argparse.Namespace) -> type[PlatformController] | None:
    """The class that --controller names, if it is given; the one way in which code is loaded.

    Raises:
        VesTwinError: code that cannot be used.
    """
    if arguments.controller is None:
        return None
    from ves_twin.control.controller import PlatformController
    from ves_twin.core.code_file import load_class

    found: type[PlatformController] = load_class(arguments.controller, PlatformController)
    return found
