"""diagnose: name what the simulation gets wrong in recordings, and extend the plant."""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.core.held_folder import HeldFolder
    from ves_twin.diagnosis.verdict.verdict import Verdict
    from ves_twin.machines.diagnose import Diagnosis

from ves_twin.cli.given import Given, add_machine_options, bank_settings

LAW_PICTURE = "law.png"
"""File with the picture of a law."""

PLANT = "plant.toml"
"""File of the extended machine, where it passed."""

NO_LAW = (
    "these numbers stand beside the law, of which MJCF has friction and damping at most; diagnose"
    " --no-law finds numbers that stand alone"
)
"""What is said where the numbers of a model were found beside a law."""

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
    parser.add_argument(
        "--exclude",
        metavar="EFFECT",
        action="append",
        default=[],
        help="a cause left out; may be repeated",
    )
    add_machine_options(parser)
    parser.add_argument(
        "--alternate",
        metavar="LENGTH",
        nargs="?",
        type=float,
        const=0.0,
        help="hold out every second stretch of LENGTH s, or poses, of each recording (without"
        " LENGTH: that of the machine's file)",
    )
    parser.add_argument(
        "--law",
        action=argparse.BooleanOptionalAction,
        help="where no cause explains the recordings, look for a law (default: if that takes"
        " minutes at most)",
    )
    parser.add_argument(
        "--model",
        metavar="MODEL",
        help="in place of --plant: draft the machine's file in the output folder, as `new` does",
    )
    parser.add_argument(
        "--minutes",
        metavar="N",
        type=float,
        default=30.0,
        help="time that it may take, of the clock where several processes work, else of the"
        " processor; it says what it leaves out then (default: 30)",
    )
    parser.add_argument("--out", metavar="DIR", help="output folder (default: runs/diagnosis)")
    parser.add_argument("--json", action="store_true", help="the verdict as JSON on stdout")


def execute(arguments: argparse.Namespace) -> int:
    """Diagnose, write verdict and plant, print the verdict."""
    from ves_twin.cli.output_folder import output_folder
    from ves_twin.core.recording.files import recording_name

    with output_folder(arguments.out, "diagnosis") as held:
        if arguments.model:
            arguments.plant = _drafted(arguments, held)
        found = _diagnose(arguments)
        _write(found, held.path, ", ".join(map(recording_name, arguments.measured)))
        text = found.verdict.to_json() if arguments.json else _text(found, held.path)
    print(text)
    return 0


def _drafted(arguments: argparse.Namespace, held: HeldFolder) -> str:
    """The machine's file, drafted beside what the diagnosis writes; what it rests on to stderr."""
    from ves_twin.cli.new_text import new_text
    from ves_twin.core.errors import InvalidInputError
    from ves_twin.machines.new_machine import new_machine

    if arguments.plant or arguments.map:
        raise InvalidInputError("--model", arguments.model, "no --plant and no --map beside it")
    model, logs = Path(arguments.model), [Path(name) for name in arguments.measured]
    drafted = new_machine(model, logs, held.path / f"{model.stem}.toml", held=held)
    print(new_text(drafted, model, logs), file=sys.stderr)
    return str(drafted.path)


def _diagnose(arguments: argparse.Namespace) -> Diagnosis:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.machines.diagnose import diagnose

    given = Given.of(arguments)
    measured, held_out = given.read(arguments.measured), given.read(arguments.held_out)
    baseline, healthy = given.read(arguments.baseline), given.read(arguments.commissioning)
    standstill = given.standstill(arguments.standstill)
    settings = replace(bank_settings(), laws=arguments.law, minutes=arguments.minutes)
    budget = settings.budget
    with RunProgress("diagnose", 1.0, unit="share", ending=budget.end) as progress:
        return diagnose(
            measured,
            given.machine,
            held_out=held_out,
            baseline=baseline,
            commissioning=healthy,
            standstill=standstill,
            exclude=arguments.exclude,
            experiment=given.experiment,
            alternate=arguments.alternate,
            settings=settings,
            progress=progress.share,
            budget=budget,
        )


def _write(found: Diagnosis, folder: Path, names: str) -> None:
    from ves_twin.machines.machine import SCENARIO, SETPOINTS
    from ves_twin.report.diagnosis.law import draw_law
    from ves_twin.report.diagnosis.page import diagnosis_page
    from ves_twin.report.diagnosis.strained import strained_sentence
    from ves_twin.report.page import write_page
    from ves_twin.report.picture import save_picture
    from ves_twin.report.rerun.diagnosis import write_diagnosis_rrd

    for name in (
        PLANT,
        "plant.candidate.toml",
        LAW_PICTURE,
        SETPOINTS,
        SCENARIO,
    ):  # of an earlier run
        (folder / name).unlink(missing_ok=True)
    found.verdict.save(folder / "verdict.json")
    title = f"Diagnosis of {names} by the model {found.machine.name}"
    page = diagnosis_page(found.verdict, title, _plant_sentence(found))
    write_page(folder / "report.html", page)
    write_diagnosis_rrd(found.verdict, folder / "diagnosis.rrd", found.machine.drawing())
    law = found.verdict.law
    if law is not None and law.curve is not None:
        save_picture(draw_law(law), folder / LAW_PICTURE)
    note = f"Extended by ves-twin diagnose: {found.verdict.words}{strained_sentence(found.verdict)}"
    if found.extended is not None and found.refused:
        path = folder / "plant.candidate.toml"
        found.extended.save(path, f"{note}\nOnly a candidate: {found.refused}.")
    elif found.extended is not None:
        found.extended.save(folder / PLANT, note)
    elif found.nearest is not None:
        path = folder / "plant.candidate.toml"
        found.nearest.save(path, f"{note}\nThe nearest, not accepted: {found.refused}.")
    if found.excitation is not None:
        found.machine.save_excitation(found.excitation, folder)


def _plant_sentence(found: Diagnosis) -> str:
    """What became of the extended plant."""
    law = found.verdict.law
    if law is not None and law.claimed and found.refused:
        return f"The plant with the law is a candidate, plant.candidate.toml: {found.refused}."
    if found.extended is None and found.verdict.causes:
        return f"No extended plant was written: {found.refused}."
    if found.nearest is not None:
        return (
            "plant.candidate.toml has what comes nearest, with its sizes. It was not accepted: no"
            " cause is named."
        )
    if found.extended is None:
        return "No extended plant was written: no cause is named."
    if found.refused:
        return f"The extended plant is a candidate, plant.candidate.toml: {found.refused}."
    if found.verdict.gain is not None and found.verdict.gain.lost:
        return (
            "The extended plant is plant.toml. The model as it was given predicts every held-out"
            " channel as well or better."
        )
    from ves_twin.report.diagnosis.mjcf_lines import mjcf_lines
    from ves_twin.report.diagnosis.simulated_lines import simulated_lines

    told = (
        "The extended plant is plant.toml; it passed on held-out recordings. ves-twin info --plant"
        " plant.toml --mjcf improved.xml writes it as plain MJCF, and says what that cannot carry."
    )
    return " ".join([told, *mjcf_lines(found.carried), *simulated_lines(found.simulated)])


def law_lines(verdict: Verdict) -> list[str]:
    """What the lines above do not say of a law: its name, and beside no cause what it is worth."""
    from ves_twin.report.diagnosis.law import law_sentences
    from ves_twin.report.diagnosis.proved import ended

    if verdict.law is None:
        return []
    above = (1 if verdict.law.part else 2) if verdict.law.claimed else 0
    first, *rest = law_sentences(verdict.law, ended(verdict))[above:]
    return [f"law       {first}", *(f"          {text}" for text in rest)]


def _text(found: Diagnosis, folder: Path) -> str:
    from ves_twin.report.diagnosis.answer import (
        confidence_sentence,
        next_step,
        suspect_words,
        verdict_sentence,
    )
    from ves_twin.report.diagnosis.basis import gain_words, rests_on
    from ves_twin.report.diagnosis.coarse_step import coarse_sentence
    from ves_twin.report.diagnosis.flaws import flaw_lines
    from ves_twin.report.diagnosis.mjcf_lines import mjcf_lines
    from ves_twin.report.diagnosis.out_of_step import out_of_step_sentence
    from ves_twin.report.diagnosis.proved import (
        inseparable_lines,
        near_sentence,
        proof_sentence,
        proved_line,
    )
    from ves_twin.report.diagnosis.simulated_lines import simulated_lines
    from ves_twin.report.diagnosis.strained import tuned_words
    from ves_twin.report.diagnosis.words import ambiguity_sentences, interval_words, name_of

    verdict = found.verdict
    doubts = [coarse_sentence(verdict), out_of_step_sentence(verdict), *flaw_lines(verdict.quality)]
    lines = [
        f"verdict   {verdict.verdict.value}: {verdict_sentence(verdict)}",
        *(f"          {text}" for text in ambiguity_sentences(verdict)),
        *(f"          {text}" for text in filter(None, [suspect_words(verdict)])),
        f"how sure  {confidence_sentence(verdict)}",
        f"next      {next_step(verdict)}",
        f"rests on  {rests_on(verdict.basis)}",
        *(f"          {text}" for text in filter(None, doubts)),
    ]
    for cause in () if verdict.proved else verdict.causes:
        for name, size in cause.largest.items():
            lines.append(f"size      {name_of(cause)}: {name}, 90 % {interval_words(size)}")
    said = {"tuned": tuned_words(verdict), "gain": gain_words(verdict)}
    lines += [f"{name:<10}{words}" for name, words in said.items() if words]
    lines += law_lines(verdict)
    if verdict.put_to_proof is not None:
        lines += ["", f"  {proof_sentence(verdict)}", *map(proved_line, verdict.proved)]
        lines += [f"  {near_sentence(verdict)}"] if near_sentence(verdict) else []
        lines += [f"  {text}" for text in inseparable_lines(verdict)]
    width = _width(verdict)
    head = f"  {'channel':<{width}}    before     tuned  {_last(verdict)}"
    lines += ["", f"{head}   (rms error; tuned: by tolerances alone)"]
    for name, error in verdict.residuals.items():
        tuned = error.after_si if error.tolerances_si is None else error.tolerances_si
        numbers = "".join(f"{e:10.3g}" for e in (error.before_si, tuned, error.after_si))
        lines.append(f"  {name:<{width}}{numbers}   {error.unit}")
    lines += held_out_table(verdict)
    if found.extended is not None and found.refused:
        lines += ["", f"  plant.candidate.toml, no plant.toml: {found.refused}"]
    lines += [f"  {text}" for text in simulated_lines(found.simulated)]
    files = ", ".join(sorted(p.name for p in folder.iterdir()))
    lines += ["", f"  files     {folder}/: {files}"]
    if (folder / PLANT).is_file():
        beside = verdict.law is not None and verdict.law.claimed and bool(verdict.proved)
        lines.append(f"  as MJCF   ves-twin info --plant {folder / PLANT} --mjcf improved.xml")
        lines += [f"            {text}" for text in mjcf_lines(found.carried)]
        lines += [f"            {NO_LAW}"] * beside
    return "\n".join(lines)


def held_out_table(verdict: Verdict) -> list[str]:
    """A table of held-out errors; with a law of what causes leave, if one is claimed."""
    gain, law = verdict.gain, verdict.law
    if gain is None or not gain.errors:
        return []
    beside = law.gain if law is not None and law.claimed and law.part else None
    width = _width(verdict)
    head = f"  {'held out':<{width}}    before     tuned  {_last(verdict)}"
    law_too = "  with law" * (beside is not None)
    lines = ["", f"{head}{law_too}   (rms error; fitted elsewhere, but for each start)"]
    for name, (tuned, after) in gain.errors.items():
        ends = [gain.given.get(name, math.nan), tuned, after]
        if beside is not None:
            ends.append(beside.errors.get(name, (math.nan, math.nan))[1])
        numbers = "".join(f"{e:10.3g}" for e in ends)
        lines.append(f"  {name:<{width}}{numbers}   {verdict.residuals[name].unit}")
    return lines


def _last(verdict: Verdict) -> str:
    """Head of the last column: with the causes, or with what comes nearest, which is none."""
    law = verdict.law is not None and verdict.law.claimed
    return f"{'after' if verdict.causes or law else 'nearest':>8}"


def _width(verdict: Verdict) -> int:
    """Of the names of channels in a table."""
    return max(18, *map(len, verdict.residuals))
