"""Mutation testing of the compiled kernels and of the diagnosis core.

    python benchmarks/mutation.py runs/mutation.jsonl                 # goes on where it stopped
    python benchmarks/mutation.py runs/mutation.jsonl --again         # survivors once more
    python benchmarks/mutation.py runs/mutation.jsonl --report        # score and survivors only

A mutant is one small wrong change (`mutants.py`). Each is written into a copy of the project, and
the tests that cover its module are run there until one fails. The sample is fixed: the mutants
whose hash with SEED is smallest, so that edits elsewhere do not change it. Compiled code is cached
in a folder of the mutant's own, so that none runs the code of another.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from mutants import Mutant, mutants_of

ROOT = Path(__file__).resolve().parents[1]
SEED = 19
SAMPLE = 320

KILLED, TIMEOUT, SURVIVED = "killed", "timeout", "survived"

SLACK = 60.0
"""Seconds beyond four times the tests' usual time after which a mutant counts as hung."""

COPIED = ("ves_twin", "tests", "models", "scenarios", "pyproject.toml", "benchmarks")


@dataclass(frozen=True)
class Room:
    """Modules, and the tests that cover them.

    Attributes:
        modules: files below the root.
        tests: run until the first that fails; a file named as the module comes before them.
        compiled: whether the modules hold compiled code, whose cache a mutant then has alone.
    """

    modules: tuple[str, ...]
    tests: tuple[str, ...]
    compiled: bool


PHYSICS, LOOP, DIAGNOSIS = "ves_twin/plant/physics", "ves_twin/simulator", "ves_twin/diagnosis"
ROOMS = (
    Room(
        tuple(
            f"{PHYSICS}/{name}.py"
            for name in (
                "chambers", "cylinder", "delay", "force_sensor", "supply", "transducer", "valve",
            )
        ),
        ("tests/plant/physics",),
        True,
    ),
    Room(
        (f"{LOOP}/loop.py",),
        (
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
    Room(
        tuple(
            f"{DIAGNOSIS}/{name}.py"
            for name in ("whitening", "search", "refine", "explain", "gain", "assess")
        ),
        tuple(
            f"tests/diagnosis/test_{name}.py"
            for name in (
                "whitening", "refine", "search", "search_steps", "gain", "assess", "explain",
                "diagnose", "build_up", "bad_input", "differential", "grid", "plan", "forecast",
                "lacking",
            )
        ),
        False,
    ),
)  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file", type=Path, help="results, a JSON line for each mutant")
    parser.add_argument("--sample", type=int, default=SAMPLE, help="mutants of all")
    parser.add_argument("--module", default="", help="only those with this in their path")
    parser.add_argument("--again", action="store_true", help="run the survivors once more")
    parser.add_argument("--report", action="store_true", help="run nothing, print what is known")
    options = parser.parse_args()
    chosen, total = _sample(options.sample)
    done = _done(options.file)
    if not options.report:
        again = {SURVIVED} if options.again else set()
        left = [m for m in chosen if m.key not in done or done[m.key] in again]
        left = [m for m in left if options.module in m.module]
        _run(left, options.file)
        done = _done(options.file)
    print(_report(chosen, total, done))


def _sample(count: int) -> tuple[list[Mutant], int]:
    every = [m for room in ROOMS for name in room.modules for m in mutants_of(ROOT / name, name)]
    every.sort(key=lambda m: hashlib.sha256(f"{SEED} {m.key}".encode()).hexdigest())
    return every[:count], len(every)


def _done(file: Path) -> dict[str, str]:
    if not file.exists():
        return {}
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    return {row["key"]: row["outcome"] for row in rows}


def _run(left: list[Mutant], file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        copy = _copy(Path(folder) / "project")
        usual: dict[Room, float] = {}
        for number, mutant in enumerate(left, 1):
            room = next(r for r in ROOMS if mutant.module in r.modules)
            if room not in usual:
                outcome, usual[room] = _tested(copy, room, "", None)
                if outcome != SURVIVED:
                    sys.exit(f"the tests of {room.modules[0]} fail without a mutant: {outcome}")
            target = copy / mutant.module
            source = target.read_text(encoding="utf-8")
            target.write_text(mutant.text(source), encoding="utf-8")
            limit = 4.0 * usual[room] + SLACK
            outcome, seconds = _tested(copy, room, mutant.module, limit)
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
    return folder


def _tested(copy: Path, room: Room, module: str, limit: float | None) -> tuple[str, float]:
    """Outcome and seconds of the tests in the copy; compiled code is kept from mutant to mutant
    only where the mutants are not compiled."""
    cache = copy.parent / ("cache-of-one" if room.compiled else "cache")
    environment = {
        **os.environ,
        "PYTHONPATH": str(copy),
        "PYTHONDONTWRITEBYTECODE": "1",  # a mutant of the same second and size would run stale
        "XDG_CACHE_HOME": str(cache),
        "OPENBLAS_NUM_THREADS": "1",
    }
    own = [t for t in (copy / "tests").rglob(f"test_{Path(module).stem}.py") if module]
    tests = dict.fromkeys([*(str(t.relative_to(copy)) for t in own), *room.tests])
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-m", "not slow"]
    command += ["-p", "no:cacheprovider", "-p", "no:randomly", *tests]
    begin = time.monotonic()
    process = subprocess.Popen(
        command, cwd=copy, env=environment, start_new_session=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        code = process.wait(limit)
        outcome = SURVIVED if code == 0 else KILLED
        if code not in (0, 1, 2) and code > 0:
            outcome = f"no tests ran ({code})"
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        outcome = TIMEOUT
    if room.compiled:
        shutil.rmtree(cache, ignore_errors=True)
    return outcome, time.monotonic() - begin


def _report(chosen: list[Mutant], total: int, done: dict[str, str]) -> str:
    known = [m for m in chosen if m.key in done]
    survivors = [m for m in known if done[m.key] == SURVIVED]
    lines = ["| module | mutants | killed | timeouts | survived |", "|---|--:|--:|--:|--:|"]
    for name in dict.fromkeys(
        m.module for room in ROOMS for m in known if m.module in room.modules
    ):
        here = [done[m.key] for m in known if m.module == name]
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
