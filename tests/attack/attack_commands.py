"""A standing attack on every command that writes: kills, pairs in one folder, full disks, odd homes.

    python tests/attack/attack_commands.py --kills 200 --others 100     # part of `make attack`
    python tests/attack/attack_commands.py --seed 5 --kills 1 --others 0

A run that is killed at a random time keeps every row older than KEPT, with the values of a run that
was left alone; any other command leaves whole files or none, and ends as well as before once it is
started again. Commands run in forked children of one warm process.
"""

from __future__ import annotations

import argparse
import io
import os
import random
import resource
import shutil
import signal
import struct
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path

import numpy as np

import ves_twin as vt
from ves_twin.cli import progress
from ves_twin.cli.main import main
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import Recording
from ves_twin.core.recording.stream import FILE_NAME, STREAM_NAME

KEPT = 1.0
"""Rows that are older than this when a kill comes must be there [s]."""

SCENARIO = "position_sine"
SETTINGS = {"run.settle": 0.2, "run.duration": 60.0}
LONGEST = 4.0
"""A kill comes at most so long after a command has begun [s]."""

EARLY = 0.1
"""Share of the kills that count from the start of the process, not of the motion."""

TAKEN = "another command"

_STAMP = struct.Struct("dd")

Program = Callable[[], int]


def child(program: Program, log: Path) -> int:
    """A forked process that runs a program, its words in a file; its number."""
    number = os.fork()
    if number:
        return number
    code = 70
    try:
        words = io.StringIO()
        with redirect_stderr(words), redirect_stdout(io.StringIO()):
            try:
                code = program()
            except BaseException:
                traceback.print_exc()
        log.write_text(words.getvalue())
    finally:
        os._exit(code)


def ended(number: int) -> int:
    """How a child ended: its exit code, negative where a signal ended it."""
    return os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])


def scenario(duration: float) -> vt.Scenario:
    return vt.Scenario.load(SCENARIO, {**SETTINGS, "run.duration": duration})


class Attack:
    """Draws, attacks, and counts what was wrong."""

    def __init__(self, seed: int, place: Path) -> None:
        self.rng = random.Random(seed)
        self.place = place
        self.faults: list[str] = []
        self.counts: Counter[str] = Counter()
        self.oldest = 0.0
        self._whole: dict[int, Recording] = {}

    def check(self, right: bool, words: str) -> None:
        if not right:
            self.faults.append(words)
            print(f"FAULT {words}", flush=True)

    def whole(self, seed: int) -> Recording:
        """The run of a seed, left alone."""
        if seed not in self._whole:
            self._whole[seed] = vt.simulate(scenario(SETTINGS["run.duration"]), seed=seed)
        return self._whole[seed]

    def same(self, found: Recording, name: str) -> None:
        """Rows are those of the run of its seed."""
        whole, count = self.whole(found.info.seed), len(found)
        right = np.array_equal(found.time, whole.time[:count]) and all(
            np.array_equal(values, whole[signal][:count], equal_nan=True)
            for signal, values in found.signals.items()
        )
        self.check(right, f"{name}: {count} rows are not those of seed {found.info.seed}")

    def kill(self, turn: int) -> None:
        """A run, killed; every third folder is used again by the next one."""
        folder = self.place / f"killed-{turn // 3}"
        duration = self.rng.choice(
            [5.0, SETTINGS["run.duration"]]
        )  # so that some kills find its end
        seed = self.rng.choice([1, 2])
        read, write = os.pipe()

        def program() -> int:
            def note(reached: float) -> None:
                os.write(write, _STAMP.pack(time.monotonic(), reached))

            vt.record(scenario(duration), folder, seed=seed, progress=note)
            return 0

        number = child(program, self.place / "log")
        os.close(write)
        early = self.rng.random() < EARLY
        first = b"" if early else os.read(read, _STAMP.size)  # waits until it is under way
        time.sleep(self.rng.uniform(0.0, LONGEST))
        os.kill(number, signal.SIGKILL)
        at = time.monotonic()
        code = ended(number)
        with os.fdopen(read, "rb") as pipe:
            stamps = list(_STAMP.iter_unpack(first + pipe.read()))
        self.counts["killed" if code < 0 else "had ended"] += 1
        old = [reached for when, reached in stamps if when <= at - KEPT]
        there = [name for name in (STREAM_NAME, FILE_NAME) if (folder / name).exists()]
        if not old:
            self.counts["before its first second"] += 1
            return
        found = load_recording(folder)
        last = float(found.time[-1])
        self.same(found, f"kill {turn}")
        period = found.info.period
        self.counts["with rows to hold against"] += 1
        self.check(
            found.info.seed == seed and last >= min(old[-1], duration) - 2.0 * period,
            f"kill {turn}: {there} end at {last:.3f} s, {old[-1]:.3f} s was a second old",
        )
        lost = [at - when for when, reached in stamps if reached > last + 2.0 * period]
        self.oldest = max([self.oldest, *lost])

    def pair(self, turn: int) -> None:
        """Two runs in one folder at a time: one of them right, the other refused."""
        folder = self.place / f"pair-{turn}"
        words = ["run", SCENARIO, "--set", "run.settle=0.2", "--set", "run.duration=4", "--no-rrd"]
        logs = [self.place / f"log-{seed}" for seed in (1, 2)]
        numbers = []
        for seed, log in zip((1, 2), logs, strict=True):
            given = [*words, "--out", str(folder), "--seed", str(seed)]
            numbers.append(child(lambda given=given: main(given), log))
            time.sleep(self.rng.uniform(0.0, 0.6))
        codes = [ended(number) for number in numbers]
        self.counts[f"pair ended {sorted(codes)}"] += 1
        for code, log in zip(codes, logs, strict=True):
            said = log.read_text()
            right = code == 0 or (code == 2 and TAKEN in said and said.count("\n") == 1)
            self.check(right, f"pair {turn}: {code} {said[-300:]}")
        found = load_recording(folder)
        self.check(codes[found.info.seed - 1] == 0, f"pair {turn}: the refused one is there")
        self.same(found, f"pair {turn}")

    def commands(self, source: Path) -> dict[str, list[str]]:
        """Name -> a command that writes `out`."""
        short = ["--set", "run.settle=0.2", "--set", "run.duration=1.5"]
        return {
            "run": ["run", SCENARIO, *short, "--out", "out"],
            "compare": ["compare", str(source), "--out", "out"],
            "csv": ["export", str(source), "--out", "out/r.csv"],
            "parquet": ["export", str(source), "--out", "out/r.parquet"],
            "mat": ["export", str(source), "--out", "out/r.mat"],
            "map": ["inspect", str(source / FILE_NAME), "--out", "out/m.toml"],
            "figure": ["reproduce", "fig-5-2", "--out", "out"],
            "blind": ["blind", "make", "--cases", "1", "--out", "out/suite", "--seed", "1"],
        }

    def other(self, turn: int, source: Path) -> None:
        """Another command: killed, on a full disk, or at an odd place; then started again."""
        name, words = self.rng.choice(sorted(self.commands(source).items()))
        how = self.rng.choice(["kill", "disk", "odd"])
        folder = self.place / f"other-{turn}"
        folder.mkdir()
        limit = int(10 ** self.rng.uniform(1.0, 6.5))
        odd = self.rng.choice([{"HOME": ""}, {"TZ": "Asia/Kathmandu"}, {"HOME": "/dev/null"}])
        umask = self.rng.choice([0o000, 0o077, 0o027])

        def program() -> int:
            os.chdir(folder)
            if how == "disk":
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            if how == "odd":
                os.environ.update(odd)
                time.tzset()
                os.umask(umask)
            return main(words)

        log = self.place / "log"
        log.unlink(missing_ok=True)
        number = child(program, log)
        if how == "kill":
            time.sleep(self.rng.uniform(0.0, LONGEST))
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        code = ended(number)
        self.counts[f"{how} {name}: {code}"] += 1
        said = log.read_text() if log.exists() else ""
        expected = {"kill": (0, -9), "disk": (0, 2), "odd": (0,)}[how]
        lines = 1 if code == 2 else 0
        what = f"{how} {turn} {name}"
        self.check(code in expected and said.count("\n") <= max(lines, 1), f"{what}: {code} {said}")
        self._files_are_whole(folder, what, how != "kill")
        again = child(lambda: (os.chdir(folder), main(words))[1], log)
        code = ended(again)
        self.check(code == 0, f"{what}, again: {code} {log.read_text()[-300:]}")
        self._files_are_whole(folder, f"{what}, again", False)
        shutil.rmtree(folder)

    def _files_are_whole(self, folder: Path, what: str, tidy: bool) -> None:
        """Every file with a name of its own can be read; drafts remain of a kill alone."""
        for path in folder.rglob("*"):
            if path.name.startswith("."):
                self.check(not tidy, f"{what}: leaves {path.name}")
            elif path.suffix == ".parquet":
                self.check(len(load_recording(path)) > 0, f"{what}: {path.name}")
            elif path.suffix in {".json", ".html", ".csv", ".mat", ".png", ".toml"}:
                self.check(path.stat().st_size > 0, f"{what}: {path.name} is empty")


def attack(seed: int, kills: int, others: int, place: Path) -> Attack:
    """Carry it out.

    Args:
        seed: of all draws.
        kills: runs that are killed.
        others: attacks on other commands, and a fifth as many pairs.
        place: an empty folder.
    """
    progress.FIRST = 3600.0  # lines of progress come by the clock
    found = Attack(seed, place)
    source = place / "source"
    short = {**SETTINGS, "run.duration": 3.0}
    vt.record(vt.Scenario.load(SCENARIO, short), source, seed=1)
    for turn in range(kills):
        found.kill(turn)
    for turn in range((others + 4) // 5):
        found.pair(turn)
    for turn in range(others):
        found.other(turn, source)
    return found


def command() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--kills", type=int, default=200, help="runs that are killed")
    parser.add_argument("--others", type=int, default=100, help="attacks on other commands")
    parser.add_argument("--seed", type=int, default=None)
    given = parser.parse_args()
    seed = random.SystemRandom().randrange(10**6) if given.seed is None else given.seed
    print(f"seed {seed}", flush=True)
    with tempfile.TemporaryDirectory(prefix="attack-") as place:
        found = attack(seed, given.kills, given.others, Path(place))
    for name, count in sorted(found.counts.items()):
        print(f"{count:6d}  {name}")
    print(f"lost at most {found.oldest:.2f} s before a kill; {len(found.faults)} faults")
    return 1 if found.faults else 0


if __name__ == "__main__":
    sys.exit(command())
