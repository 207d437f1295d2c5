"""view: look at a recording or a scenario in rerun, or step a scenario in MuJoCo's viewer."""

from __future__ import annotations

import argparse
import difflib
import os
import re
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from ves_twin.cli.exit_codes import exit_code
from ves_twin.cli.run import add_run_options, load, load_controller, run_scenario
from ves_twin.core.errors import FileAccessError, InvalidInputError, UnknownNameError, VesTwinError

OF_A_RUN = {
    "--set": "settings",
    "--plant": "plant",
    "--seed": "seed",
    "--controller": "controller",
    "--out": "out",
    "--no-rrd": "no_rrd",
}
"""Options that only a run that is written heeds -> their attribute."""

NOT_LIVE = ("--out", "--no-rrd", "--web")
"""Options that --live cannot heed: it writes nothing and has a window of its own."""

RUNS, DIAGNOSIS = Path("runs"), "diagnosis.rrd"
"""Where commands write unless told otherwise, and the file of a diagnosis that is looked at."""

SUMMARY = "look at a recording or a scenario: rerun, or MuJoCo's viewer with --live"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "scenario", metavar="SCENARIO|RECORDING", nargs="?", help="a name, file or run folder"
    )
    parser.add_argument("--last", action="store_true", help="the newest recording below runs/")
    add_run_options(parser)
    parser.add_argument("--web", action="store_true", help="serve on 127.0.0.1 for a browser")
    parser.add_argument("--live", action="store_true", help="step a scenario in MuJoCo's viewer")


def execute(arguments: argparse.Namespace) -> int:
    """Open the viewer."""
    _choose(arguments)
    if arguments.live:
        _refuse(arguments, NOT_LIVE, "with --live")
        return _live(arguments)
    from ves_twin.report.rerun.viewer import open_viewer

    path = Path(arguments.scenario)
    is_recording = path.is_dir() or path.suffix in {".parquet", ".arrows", ".rrd"}
    if not is_recording:
        _check_something_is_there(path)
        _refuse(arguments, ("--no-rrd",), "where the rerun file is what is looked at")
        with run_scenario(arguments) as (summary, folder):
            pass
        if not (folder / "run.rrd").is_file():
            raise VesTwinError(f"nothing to look at: {summary.outcome.value}, {summary.advice}")
        return open_viewer(folder / "run.rrd", arguments.web)
    _refuse(arguments, tuple(OF_A_RUN), "on a recording, which has been made")
    if (path / DIAGNOSIS).is_file():
        path = path / DIAGNOSIS
    if path.suffix == ".rrd":
        check_rrd(path)
        return open_viewer(path, arguments.web)
    from ves_twin.core.recording.files import load_recording
    from ves_twin.report.rerun.write import write_rrd

    with tempfile.TemporaryDirectory(prefix="ves_twin-") as scratch:
        rrd = write_rrd(load_recording(path), Path(scratch) / "run.rrd")
        return open_viewer(rrd, arguments.web)


def _choose(arguments: argparse.Namespace) -> None:
    """What is looked at: what was asked for, or the newest; a newer one of its name is told of."""
    if arguments.last == (arguments.scenario is not None):
        came = f"{arguments.scenario} and --last" if arguments.last else "nothing to look at"
        raise InvalidInputError("view", came, "a scenario, a recording, or --last")
    if arguments.last:
        found = _newest(_run_folders(RUNS))
        if not found:
            raise FileAccessError("there is no recording below runs/ yet; ves-twin run makes one")
        arguments.scenario = found
        print(f"showing {found}", file=sys.stderr)
        return
    path = Path(arguments.scenario)
    again = [
        n for n in _run_folders(path.parent) if re.fullmatch(rf"{re.escape(str(path))}-\d+", n)
    ]
    later = _newest([str(path), *again]) if again and path.is_dir() else str(path)
    if later != str(path):
        print(f"{later} is newer; ves-twin view --last shows the newest", file=sys.stderr)


def _newest(folders: Sequence[str]) -> str:
    """That which was written last; empty if there is none."""
    return max(folders, key=lambda name: Path(name).stat().st_mtime, default="")


def _refuse(arguments: argparse.Namespace, options: Sequence[str], where: str) -> None:
    """Raise for an option that would be ignored."""
    for option in options:
        given = getattr(arguments, OF_A_RUN.get(option, option.lstrip("-")))
        if given is not None and given is not False and given != []:
            raise VesTwinError(f"view: {option} does nothing {where}; leave it out")


def _check_something_is_there(path: Path) -> None:
    """Say which run folder or scenario is nearest where there is none of this name."""
    from ves_twin.scenario.load import procedure_questions, scenario_questions

    if path.exists():
        return
    if len(path.parts) > 1:
        near = difflib.get_close_matches(str(path), _run_folders(path.parent), n=1, cutoff=0.5)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise FileAccessError(f"run folder, recording or scenario {path} does not exist{hint}")
    scenarios = scenario_questions() | procedure_questions()
    if str(path) not in scenarios:
        folders = [*_run_folders(Path()), *_run_folders(RUNS)]
        raise UnknownNameError("scenario or run folder", str(path), [*scenarios, *folders])


def _run_folders(folder: Path) -> list[str]:
    """Folders in a folder that hold a recording or a diagnosis."""
    from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME

    if not folder.is_dir():
        return []
    names = (FILE_NAME, STREAM_NAME, DIAGNOSIS)
    return [str(p) for p in folder.iterdir() if any((p / name).is_file() for name in names)]


def check_rrd(path: Path) -> None:
    """Raise InvalidInputError unless a file starts as a rerun file does."""
    if not path.is_file():
        return
    with path.open("rb") as file:
        if file.read(3) != b"RRF":
            raise InvalidInputError(str(path), "another kind of file", "a rerun file")


def _live(arguments: argparse.Namespace) -> int:
    """Step in real time; closing the window ends it. The exit code is that of `run`."""
    if sys.platform == "linux" and not {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ):
        raise VesTwinError("--live needs a display, and there is none; --web serves to a browser")
    import mujoco.viewer

    from ves_twin.simulator.recorder import NoSink
    from ves_twin.simulator.simulator import Simulator

    scenario, plant = load(arguments)
    controller = load_controller(arguments)
    sim = Simulator(plant, scenario, arguments.seed, sink=NoSink(), controller=controller)
    frame = 1.0 / 60.0
    panels = {"show_left_ui": False, "show_right_ui": False}
    with mujoco.viewer.launch_passive(sim.model, sim.data, **panels) as window:
        window.cam.lookat[:], window.cam.distance = (0.0, 0.0, 1.0), 4.2
        window.cam.azimuth, window.cam.elevation = 128.0, -14.0
        while window.is_running() and not sim.done:
            begin = time.perf_counter()
            sim.advance(frame)
            window.sync()
            time.sleep(max(0.0, frame - (time.perf_counter() - begin)))
    if sim.outcome is None:
        print(f"{scenario.name}: at {sim.time:.2f} s", file=sys.stderr)
        return 0
    ended = f"{sim.outcome.value} at {sim.time:.2f} s ({sim.outcome.advice})"
    print(f"{scenario.name}: {ended}", file=sys.stderr)
    return exit_code(sim.outcome)
