"""Mutation testing of the compiled kernels and of the diagnosis core.

    python benchmarks/mutation.py runs/mutation.jsonl                 # goes on where it stopped
    python benchmarks/mutation.py runs/mutation.jsonl --again         # survivors once more
    python benchmarks/mutation.py runs/mutation.jsonl --report        # score and survivors only

A mutant is one small wrong change (`mutants.py`). Each is written into a copy of the project, and
the tests that cover its module are run there until one fails. The sample is fixed: the mutants
whose hash with SEED is smallest, so that edits elsewhere do not change it. An outcome holds while
the function, or the statement of the module, that the mutant stands in is the same to the letter.
Compiled code is cached by its sources, so that none runs the code of another.
"""

from __future__ import annotations

import argparse
import compileall
import csv
import hashlib
import json
import os
import py_compile
import shutil
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from mutants import Mutant, mutants_of

ROOT = Path(__file__).resolve().parents[1]
SEED = 19
SAMPLE = 320

KILLED, TIMEOUT, SURVIVED = "killed", "timeout", "survived"

LONGEST = 1800.0
"""Processor seconds that tests may take without a mutant."""

SLACK = 20.0
"""Processor seconds beyond four times the tests' usual time after which a mutant counts as hung."""

COPIED = ("ves_twin", "tests", "models", "scenarios", "pyproject.toml", "benchmarks")


@dataclass(frozen=True)
class Room:
    """Modules, and the tests that cover them.

    Attributes:
        modules: files below the root.
        tests: run until the first that fails; a file named as the module comes before them.
        compiled: whether the modules hold compiled code, whose cache a mutant then has alone.
        loaded: what is imported once for all mutants: it imports none of the modules.
    """

    modules: tuple[str, ...]
    tests: tuple[str, ...]
    compiled: bool
    loaded: tuple[str, ...] = ()


PHYSICS, LOOP, DIAGNOSIS = "ves_twin/plant/physics", "ves_twin/simulator", "ves_twin/diagnosis"
ROOMS = (
    Room(
        tuple(
            f"{PHYSICS}/{name}.py"
            for name in (
                "chambers", "cylinder", "delay", "force_sensor", "supply", "transducer", "valve",
            )
        ),
        ("tests/plant/physics", "tests/simulator/test_loop.py"),
        True,
    ),
    Room(
        tuple(
            f"{DIAGNOSIS}/{name}.py"
            for name in (
                "record/whitening", "fit/search", "fit/refine", "fit/fits", "fit/assess",
                "explain/explain", "explain/judge", "explain/pairs", "unseen/gain",
                "unseen/held_out_gain", "build_up/proof", "build_up/weighed", "build_up/judges",
                "build_up/paired", "build_up/next_of_kin", "build_up/idle", "build_up/offer",
            )
        ),
        tuple(
            f"tests/diagnosis/{name}"
            for name in (
                "record", "fit", "explain", "unseen", "build_up", "model", "test_diagnose.py",
                "test_bad_input.py", "test_decide.py", "experiment/test_plan.py",
            )
        ),
        False,
        ("ves_twin.simulator.simulator",),
    ),
    Room(
        (f"{LOOP}/loop.py",),
        (
            "tests/simulator/test_loop.py",
            "tests/simulator/test_reference.py",
            "tests/simulator/test_simulator.py",
            "tests/simulator/test_sensor_in_the_rig.py",
            "tests/simulator/test_hydraulics.py",
            "tests/simulator/test_hydraulic_faults.py",
            "tests/simulator/test_clock.py",
            "tests/effects/test_timing_effects.py",
        ),
        True,
    ),
)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file", type=Path, help="results, a JSON line for each mutant")
    parser.add_argument("--sample", type=int, default=SAMPLE, help="mutants of all")
    parser.add_argument("--module", default="", help="only those with this in their path")
    parser.add_argument(
        "--cheap", type=float, default=np.inf, metavar="S",
        help="leave out tests above so many processor seconds but those of the module's own file",
    )  # fmt: skip
    parser.add_argument(
        "--again", nargs="*", metavar="FILE.py:LINE", help="run survivors once more, all or these"
    )
    parser.add_argument("--report", action="store_true", help="run nothing, print what is known")
    options = parser.parse_args()
    chosen, total = _sample(options.sample)
    done = _done(options.file)
    if not options.report:
        left = [m for m in chosen if m.identity not in done or _again(m, done, options.again)]
        left = [m for m in left if options.module in m.module]
        _run(left, options.file, options.cheap)
        done = _done(options.file)
    print(_report(chosen, total, done))


def _again(mutant: Mutant, done: dict[tuple[str, str], str], places: list[str] | None) -> bool:
    here = f"{mutant.module}:{mutant.line}"
    named = places is not None and (not places or any(here.endswith(p) for p in places))
    return named and done[mutant.identity] == SURVIVED


def _sample(count: int) -> tuple[list[Mutant], int]:
    every = [m for room in ROOMS for name in room.modules for m in mutants_of(ROOT / name, name)]
    every.sort(key=lambda m: hashlib.sha256(f"{SEED} {m.key}".encode()).hexdigest())
    return every[:count], len(every)


def _done(file: Path) -> dict[tuple[str, str], str]:
    """Outcome of each mutant, by its key and the text of what it stands in."""
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {(row["key"], row["around"]): row["outcome"] for row in rows if "around" in row}


def _run(left: list[Mutant], file: Path, cheap: float) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        copy = _copy(Path(folder) / "project")
        for room in ROOMS:
            here = [m for m in left if m.module in room.modules]
            if here:
                with Bench(copy, room, cheap) as bench:
                    _run_room(here, bench, file)


def _run_room(left: list[Mutant], bench: Bench, file: Path) -> None:
    bench.measure()
    for number, mutant in enumerate(left, 1):
        target = bench.copy / mutant.module
        source = target.read_text(encoding="utf-8")
        target.write_text(mutant.text(source), encoding="utf-8")
        outcome, seconds = bench.tested(mutant)
        target.write_text(source, encoding="utf-8")
        row = {**asdict(mutant), "outcome": outcome, "seconds": round(seconds, 1)}
        with file.open("a", encoding="utf-8") as rows:
            rows.write(json.dumps(row) + "\n")
        words = f"{outcome:9} {mutant.module}:{mutant.line} {mutant.new!r}"
        print(f"{number}/{len(left)} {seconds:5.0f} s {words}", file=sys.stderr, flush=True)


def _copy(folder: Path) -> Path:
    skipped = shutil.ignore_patterns("__pycache__", "*.pyc")
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=skipped)
        else:
            shutil.copy(ROOT / name, folder / name)
    checked = py_compile.PycInvalidationMode.CHECKED_HASH  # of a mutant, the time may be the same
    compileall.compile_dir(str(folder), quiet=1, invalidation_mode=checked)
    return folder


class Bench:
    """Runs the tests of a room in a copy, the quick ones first."""

    def __init__(self, copy: Path, room: Room, cheap: float) -> None:
        self.copy, self.room, self.cheap = copy, room, cheap
        self.cache = copy.parent / "cache"
        self.limit = LONGEST
        self.cost: dict[str, float] = {}
        self.calls: dict[str, list[str]] = {}

    def __enter__(self) -> Bench:
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.copy),
            "PYTHONDONTWRITEBYTECODE": "1",
            "XDG_CACHE_HOME": str(self.cache),
            "OPENBLAS_NUM_THREADS": "1",
        }
        command = [sys.executable, str(ROOT / "benchmarks/warm_tests.py"), *self.room.loaded]
        self.process = subprocess.Popen(
            command, cwd=self.copy, env=environment, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip
        return self

    def __exit__(self, *_: object) -> None:
        self.process.stdin.close()
        self.process.wait()

    def measure(self) -> None:
        """Without a mutant: all pass, what each costs, and which functions it calls."""
        costs, seen = self.copy.parent / "costs.csv", self.copy.parent / "seen.json"
        own = [f"test_{Path(module).stem}" for module in self.room.modules]
        tests = [t for t in self.room.tests if self.cheap > 0.0 or any(o in t for o in own)]
        outcome, seconds = self._asked(tests, [f"--costs={costs}"], str(seen))
        if outcome != SURVIVED:
            sys.exit(f"the tests of {self.room.modules[0]} fail without a mutant: {outcome}")
        self.limit = 4.0 * seconds + SLACK
        with costs.open(encoding="utf-8", newline="") as rows:
            self.cost = {
                row["test"]: float(row["setup"]) + float(row["call"])
                for row in csv.DictReader(rows)
            }
        self.calls = json.loads(seen.read_text(encoding="utf-8"))

    def tested(self, mutant: Mutant) -> tuple[str, float]:
        """Outcome and processor seconds: the file named as the module first, then by what tests
        cost; only those that call the function, where that can be seen."""
        own = f"test_{Path(mutant.module).stem}"
        place = f"{mutant.module}:{mutant.first}"
        every = mutant.first == 0 or self.room.compiled
        ranks = {
            test: (own not in test.split("::")[0], cost)
            for test, cost in self.cost.items()
            if every or place in self.calls[test]
        }
        tests = sorted((t for t in ranks if ranks[t] <= (True, self.cheap)), key=ranks.__getitem__)
        if not tests:
            return SURVIVED, 0.0
        outcome, seconds = self._asked(tests, [], "")
        if self.room.compiled:
            shutil.rmtree(self.cache, ignore_errors=True)
        return outcome, seconds

    def _asked(self, tests: list[str], options: list[str], seen: str) -> tuple[str, float]:
        line = {"tests": tests, "options": options, "limit": self.limit, "seen": seen}
        self.process.stdin.write(json.dumps(line) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        code = answer["code"]
        if code is None:
            return TIMEOUT, answer["seconds"]
        if code in {3, 4, 5}:
            return f"no tests ran ({code})", answer["seconds"]
        return (SURVIVED if code == 0 else KILLED), answer["seconds"]


def _report(chosen: list[Mutant], total: int, done: dict[tuple[str, str], str]) -> str:
    known = [m for m in chosen if m.identity in done]
    survivors = [m for m in known if done[m.identity] == SURVIVED]
    lines = ["| module | mutants | killed | timeouts | survived |", "|---|--:|--:|--:|--:|"]
    for name in dict.fromkeys(
        m.module for room in ROOMS for m in known if m.module in room.modules
    ):
        here = [done[m.identity] for m in known if m.module == name]
        counts = [here.count(outcome) for outcome in (KILLED, TIMEOUT, SURVIVED)]
        lines.append(f"| `{name}` | {len(here)} | {' | '.join(map(str, counts))} |")
    if known:
        share = 1.0 - len(survivors) / len(known)
        lines += [
            "",
            f"{len(known)} of a sample of {len(chosen)} ({total} possible): {share:.1%} killed",
        ]
    lines += [""] + [
        f"- `{m.module}:{m.line}` in {m.function or 'the module'}: `{' '.join(m.old.split())}`"
        f" -> `{' '.join(m.new.split())}`"
        for m in sorted(survivors, key=lambda m: (m.module, m.line))
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
