"""diagnose: name what the simulation gets wrong in recordings, and extend the plant."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.core.recording.recording import Recording
    from ves_twin.diagnosis.build_up.result import Proved
    from ves_twin.diagnosis.settings import Settings
    from ves_twin.machines.mjcf.diagnose_mjcf import MjcfDiagnosis
    from ves_twin.machines.ves2.diagnose_rig import RigDiagnosis
    from ves_twin.machines.ves2.told import Told
    from ves_twin.plant.plant import Plant

from ves_twin.cli.rig_recordings import add_rig_arguments, means_rig

SUMMARY = "name what the simulation gets wrong in recordings, extend the plant, measure the gain"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("measured", metavar="MEASURED", nargs="+", help="recordings of one rig")
    for name, words in (
        ("--held-out", "a recording that an extension must prove itself on"),
        ("--baseline", "a recording of the same programme while the rig was in order"),
        ("--commissioning", "a recording of a healthy rig; five or more"),
    ):
        parser.add_argument(
            name, metavar="REC", action="append", default=[], help=f"{words}; may be repeated"
        )
    parser.add_argument("--standstill", metavar="REC", help="the rig standing still: its noise")
    parser.add_argument(
        "--exclude",
        metavar="EFFECT",
        action="append",
        default=[],
        help="a cause left out; may be repeated",
    )
    parser.add_argument("--experiment", metavar="FILE", help="how they were made (TOML)")
    parser.add_argument(
        "--plant", metavar="FILE", help="the nominal plant, or a rig (default: as recorded)"
    )
    add_rig_arguments(parser)
    parser.add_argument("--out", metavar="DIR", help="output folder (default: runs/diagnosis)")
    parser.add_argument("--json", action="store_true", help="the verdict as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Diagnose, write verdict and plant, print the verdict."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.simulator.simulate import make_folder

    folder = output_folder(arguments.out, "diagnosis")
    diagnosed = _mjcf if means_rig(arguments) else _ves2
    found, save = diagnosed(arguments, partial(make_folder, folder))
    _write(found, folder, ", ".join(map(_label, arguments.measured)), save)
    if arguments.json:
        print(found.verdict.to_json())
    else:
        print(_text(found, folder))
    return 0


def _label(name: str) -> str:
    from ves_twin.core.recording.files import recording_name

    return recording_name(name)


def _ves2(
    arguments: argparse.Namespace, ready: Callable[[], None]
) -> tuple[RigDiagnosis, Callable[[Path, str], None]]:
    """VES II; the output folder is made once all input is read."""
    from ves_twin.cli.progress import RunProgress
    from ves_twin.cli.rig_recordings import refuse_rig_options
    from ves_twin.core.recording.files import load_recording
    from ves_twin.machines.ves2.diagnose_rig import diagnose_rig
    from ves_twin.machines.ves2.next_scenario import write_next_experiment
    from ves_twin.plant.write_plant import write_plant

    refuse_rig_options(arguments)
    measured = [load_recording(name) for name in arguments.measured]
    held_out = [load_recording(name) for name in arguments.held_out]
    baseline = [load_recording(name) for name in arguments.baseline]
    commissioning = [load_recording(name) for name in arguments.commissioning]
    standstill = load_recording(arguments.standstill) if arguments.standstill else None
    scenario = None
    if arguments.experiment:
        files = (*arguments.measured, *arguments.held_out, *arguments.baseline)
        told = _told(arguments, files, (*measured, *held_out, *baseline))
        measured = list(told.recordings[: len(measured)])
        baseline = list(told.recordings[len(measured) + len(held_out) :])
        held_out = list(told.recordings[len(measured) :][: len(held_out)])
        plant, scenario = told.plant, told.scenario
        standstill = standstill or told.standstill
    else:
        for name, recording in zip(arguments.measured, measured, strict=True):
            _needs_drive(name, recording)
        plant = _nominal(arguments.plant, measured[0])
    ready()
    with RunProgress("diagnose", 1.0, unit="share") as progress:
        found = diagnose_rig(
            measured,
            plant,
            held_out=held_out,
            commissioning=commissioning,
            standstill=standstill,
            baseline=baseline,
            exclude=arguments.exclude,
            scenario=scenario,
            settings=diagnosis_settings(),
            progress=progress.share,
        )

    def save(path: Path, note: str) -> None:
        if found.extended is not None:
            write_plant(found.extended, path, note)
        if found.next_programme is not None and found.scenario is not None:
            write_next_experiment(found.next_programme, found.scenario, plant, path.parent)

    return found, save


def _mjcf(
    arguments: argparse.Namespace, ready: Callable[[], None]
) -> tuple[MjcfDiagnosis, Callable[[Path, str], None]]:
    """A rig of two files."""
    from ves_twin.cli.progress import RunProgress
    from ves_twin.cli.rig_recordings import read_file, rig_recordings
    from ves_twin.machines.mjcf.diagnose_mjcf import diagnose_mjcf
    from ves_twin.machines.mjcf.extend import write_rig

    given = rig_recordings(arguments, arguments.measured)
    commissioning = [read_file(arguments, given.rig, n) for n in arguments.commissioning]
    ready()
    with RunProgress("diagnose", 1.0, unit="share") as progress:
        found = diagnose_mjcf(
            given.measured,
            given.rig,
            held_out=given.held_out,
            commissioning=commissioning,
            standstill=given.standstill,
            baseline=given.baseline,
            exclude=arguments.exclude,
            settings=diagnosis_settings(),
            progress=progress.share,
        )

    def save(path: Path, note: str) -> None:
        rig = found.extended or found.nearest
        if rig is not None:
            write_rig(rig, path, note)

    return found, save


def diagnosis_settings() -> Settings:
    """All cores, banks kept beside the compiled code."""
    from ves_twin.core.compiled import cache_folder
    from ves_twin.diagnosis.settings import Settings

    return Settings(workers=os.cpu_count() or 1, cache=cache_folder().parent / "banks")


def _told(
    arguments: argparse.Namespace, files: Sequence[str], recordings: Sequence[Recording]
) -> Told:
    """Recordings, scenario and plant as the experiment file says."""
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.core.recording.files import recording_name
    from ves_twin.machines.ves2.told import tell
    from ves_twin.plant.plant import Plant
    from ves_twin.scenario.experiment import Experiment

    plant = Plant.load(arguments.plant) if arguments.plant else None
    named = dict(zip(map(recording_name, files), recordings, strict=True))
    if len(named) < len(recordings):
        raise InvalidInputError("recordings", "two of one name", "names that tell them apart")
    return tell(named, Experiment.load(arguments.experiment), plant)


def _needs_drive(name: str, recording: Recording) -> None:
    """Raise unless a recording without an experiment file has all that the rig was told."""
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.machines.ves2.forward import DRIVE

    missing = [signal for signal in DRIVE if signal not in recording.signals]
    if missing:
        wanted = "what the rig was told, or an --experiment file that says it"
        raise InvalidInputError(name, f"no {missing[0]}", wanted)


def _nominal(given: str | None, recording: Recording) -> Plant:
    """The plant asked for, or the shipped one of the recording's form without its changes."""
    from ves_twin.plant.plant import Plant

    return Plant.load(given or recording.info.plant_base or "ves2")


def _write(
    found: RigDiagnosis | MjcfDiagnosis,
    folder: Path,
    names: str,
    save: Callable[[Path, str], None],
) -> None:
    from ves_twin.machines.ves2.next_scenario import SCENARIO, SETPOINTS
    from ves_twin.report.diagnosis.page import diagnosis_page
    from ves_twin.report.page import write_page
    from ves_twin.report.rerun.diagnosis import write_diagnosis_rrd

    of_earlier = ("plant.toml", "plant.candidate.toml", SETPOINTS, SCENARIO)
    for name in of_earlier:
        (folder / name).unlink(missing_ok=True)
    found.verdict.save(folder / "verdict.json")
    page = diagnosis_page(found.verdict, f"Diagnosis of {names}", _plant_sentence(found))
    write_page(folder / "report.html", page)
    write_diagnosis_rrd(found.verdict, folder / "diagnosis.rrd")
    note = f"Extended by ves-twin diagnose: {found.verdict.words}"
    if found.refused:
        save(folder / "plant.candidate.toml", f"{note}\nOnly a candidate: {found.refused}.")
    else:
        save(folder / "plant.toml", note)


def _plant_sentence(found: RigDiagnosis | MjcfDiagnosis) -> str:
    """What became of the extended plant."""
    from ves_twin.machines.mjcf.diagnose_mjcf import MjcfDiagnosis

    if found.extended is None and found.verdict.causes:
        return f"No extended plant was written: {found.refused}."
    if isinstance(found, MjcfDiagnosis) and found.extended is None and found.nearest is not None:
        return (
            "plant.candidate.toml has what comes nearest, with its sizes. It was not accepted: no"
            " cause is named."
        )
    if found.extended is None:
        return "No extended plant was written: no cause is named."
    if found.refused:
        return f"The extended plant is a candidate, plant.candidate.toml: {found.refused}."
    return "The extended plant is plant.toml; it passed on held-out recordings."


def _text(found: RigDiagnosis | MjcfDiagnosis, folder: Path) -> str:
    from ves_twin.core.quantity import shares
    from ves_twin.report.diagnosis.proved import inseparable_sentences, proof_sentence
    from ves_twin.report.diagnosis.words import ambiguity_sentences, headline

    verdict = found.verdict
    basis = verdict.basis
    lines = [
        f"verdict   {verdict.verdict.value}",
        f"          {headline(verdict) if verdict.proved else verdict.words}",
        *(f"          {text}" for text in ambiguity_sentences(verdict)),
        f"basis     noise {basis.noise}, tolerances {basis.tolerances},"
        f" held-out recordings {basis.held_out}, baseline {basis.baseline}",
    ]
    if verdict.gain is not None and verdict.gain.share is not None:
        gain = verdict.gain
        share, low, high = shares(gain.share, gain.low, gain.high)
        lines.append(f"gain      {share} of the excess on held-out recordings ({low} to {high})")
    if verdict.put_to_proof is not None:
        lines += ["", f"  {proof_sentence(verdict)}", *(_proved_line(o) for o in verdict.proved)]
        lines += [f"  not separated: {text}" for text in inseparable_sentences(verdict)]
    lines += ["", "  channel             before     after   (rms, in the channel's unit)"]
    for name, error in verdict.residuals.items():
        lines.append(f"  {name:<18}{error.before_si:10.3g}{error.after_si:10.3g}   {error.unit}")
    if verdict.gain is not None and verdict.gain.errors:
        lines += ["", "  held out            before     after   (nothing tuned there)"]
        for name, (before, after) in verdict.gain.errors.items():
            unit = verdict.residuals[name].unit
            lines.append(f"  {name:<18}{before:10.3g}{after:10.3g}   {unit}")
    if found.extended is not None and found.refused:
        lines += ["", f"  plant.candidate.toml, no plant.toml: {found.refused}"]
    files = ", ".join(sorted(p.name for p in folder.iterdir()))
    return "\n".join([*lines, "", f"  files     {folder}/: {files}"])


def _proved_line(one: Proved) -> str:
    from ves_twin.core.quantity import quantity
    from ves_twin.report.diagnosis.proved import standing_words

    sizes = ", ".join(
        f"{quantity(s.value, s.unit)} ({quantity(s.low, s.unit)} to {quantity(s.high, s.unit)})"
        for s in one.parameters.values()
    )
    return f"  {one.label:<36}{sizes}; {standing_words(one)}"
