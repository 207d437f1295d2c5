"""Diagnose measured machines of public data and print the table: what is left, what is proved.

    python benchmarks/real_machines.py [SET...] [--only TEXT] [--law] [--exclude KIND...]
        [--noise SEED] [--data FOLDER] [--out FOLDER]

The data are no part of the project: sets that are not there are left out, and said to be.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from real.machine import Set

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.settings import Settings
from ves_twin.machines.diagnose import Diagnosis, diagnose
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.report.diagnosis.law import law_sentences
from ves_twin.report.diagnosis.page import diagnosis_page
from ves_twin.report.page import write_page

SETS = (
    *("tx40", "damper", "silverbox", "dfki_double_pendulum", "eha_hydraulic_cylinder"),
    *("rc_hydraulic_excavator", "xmate7p_7axis", "embir_actuator_bench"),
)
"""Folders of the public data that a machine is written for here."""

SETTINGS = Settings(nulls=40, simulated_nulls=False)
"""Fewer than usual, and none simulated: thresholds matter little where causes stand out by
thousands of chi^2."""

DATA = Path(__file__).parents[1] / ".." / "shared" / "data"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="SET", help=f"of {', '.join(SETS)}; all")
    parser.add_argument("--data", type=Path, default=os.environ.get("VES_TWIN_DATA", DATA))
    parser.add_argument("--out", type=Path, default=Path("runs/real"))
    parser.add_argument("--only", default="", metavar="TEXT", help="questions that have it in them")
    parser.add_argument("--law", action="store_true", help="look for a law of what causes leave")
    parser.add_argument("--exclude", nargs="*", default=(), metavar="KIND", help="causes left out")
    parser.add_argument("--noise", type=int, metavar="SEED", help="add noise of the declared sd")
    told = parser.parse_args()
    settings, rows = replace(SETTINGS, laws=told.law), []
    for name in told.names or SETS:
        if name not in SETS:
            print(f"{name}: no such set; there are {', '.join(SETS)}", file=sys.stderr)
            return 2
        folder = Path(told.data) / name
        if not folder.is_dir():
            print(f"{name}: not in {told.data}, left out", file=sys.stderr)
            continue
        module = importlib.import_module(f"real.{name}")
        asked = module.sets(Path(told.data), told.out / name)
        for one in (one for one in asked if told.only in one.name):
            one = one if told.noise is None else one.noisy(told.noise)
            rows.append(row(one, told.out / name, settings, told.exclude))
            print(rows[-1], flush=True)
    print("\n".join(["", *HEAD, *rows]))
    return 0


HEAD = (
    "| set | before | held out, as found | expert | asked | proved of tested | firm | minutes |",
    "|---|--:|--:|--:|--:|--:|--:|--:|",
)


def row(one: Set, folder: Path, settings: Settings, exclude: Sequence[str]) -> str:
    """Diagnose one set, keep its page and its plant, and say what came out."""
    begin = time.process_time()
    try:
        found = diagnose(
            one.fitted,
            one.rig,
            held_out=one.held_out,
            exclude=exclude,
            settings=settings,
            progress=tell,
        )
    except InvalidInputError as refused:
        print(f"    refused: {refused}", file=sys.stderr)
        return f"| {one.name} | - | refused | {one.expert} | {one.asked} | - | - | - |"
    minutes = (time.process_time() - begin) / 60.0
    keep(one, found, folder)
    verdict = found.verdict
    before, after = errors(one, found)
    count = f"{len(verdict.proved)} of {verdict.put_to_proof or 0}"
    firm = sum(p.firm for p in verdict.proved)
    for p in verdict.proved:
        sizes = ", ".join(
            f"{n} {s.value:.3g} ({s.low:.3g} to {s.high:.3g})" for n, s in p.parameters.items()
        )
        like = "" if p.firm else f" acts like {' or '.join([p.label, *p.acts_like])}"
        print(f"    {p.label}: {sizes}, p {p.p:.0e}{like}", file=sys.stderr)
    if verdict.law is not None:
        print("    " + "\n    ".join(law_sentences(verdict.law)), file=sys.stderr)
    return (
        f"| {one.name} | {before} | {after} | {one.expert} | {one.asked} | {count} | {firm} |"
        f" {minutes:.1f} |"
    )


def errors(one: Set, found: Diagnosis) -> tuple[str, str]:
    """Pooled error on held-out recordings before and after: of one channel or two the rms of each,
    of many the share of their norm; or what the set itself calls its error."""
    if one.error is not None:
        extended = found.extended
        after = one.error(extended.rig, one.held_out) if isinstance(extended, MjcfMachine) else "-"
        return one.error(one.rig, one.held_out), after
    gain = found.verdict.gain
    if gain is None or not gain.errors:
        return "-", "-"
    rms = np.array(list(gain.errors.values()))
    if len(rms) <= 2:
        unit = next(iter(found.verdict.residuals.values())).unit
        before, after = (", ".join(f"{value:.4g}" for value in column) for column in rms.T)
        return f"{before} {unit}", f"{after} {unit}"
    signals = [np.concatenate([r[name] for r in one.held_out]) for name in gain.errors]
    norm = np.sqrt(np.sum([np.mean(np.square(s)) for s in signals]))
    before, after = 100.0 * np.sqrt(np.sum(rms**2, axis=0)) / norm
    return f"{before:.1f} %", f"{after:.1f} %"


def keep(one: Set, found: Diagnosis, folder: Path) -> None:
    name = one.name.replace(", ", "-").replace(" ", "-")
    found.verdict.save(folder / f"{name}.verdict.json")
    write_page(folder / f"{name}.html", diagnosis_page(found.verdict, one.name))
    if found.extended is not None:
        found.extended.save(folder / f"{name}.plant.toml", found.verdict.words)


def tell(share: float, what: str) -> None:
    print(f"\r{what:<40}{share:6.0%}", end="", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
