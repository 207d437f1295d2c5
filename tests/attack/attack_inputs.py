"""A standing attack on every reader: inputs drawn from grammars, and harmed copies of good files.

    python tests/attack/attack_inputs.py --inputs 20000            # `make attack`
    python tests/attack/attack_inputs.py --only lab.mcap 17        # one input again, by its seed

Each input must be read or refused in one line: no other exception, nothing else on stderr, no
warning where it is read, no file left behind, no more than SECONDS and no more than MEMORY. Inputs
run in a process of their own kind, which is begun anew when one of them kills it.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing as mp
import os
import random
import resource
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import ves_twin as vt
from ves_twin.core.errors import VesTwinError, VesTwinWarning

sys.path.insert(0, str(Path(__file__).resolve().parent))

SECONDS = 60.0
"""Longest that one input may take, on a machine that others use."""

MEMORY = 10**9
"""Most that a process may hold while it reads one [bytes]."""

PROGRAM = 250_000_000
"""What the warm program takes alone [bytes]: a test runner that forks is larger, which no input is
to blame for."""

LONGEST = 1500
"""Characters of the longest message that still counts as a line."""

EACH = 500
"""Inputs of a process; then a new one takes over, so that what leaks does not add up."""


@dataclass(frozen=True)
class Outcome:
    """What became of one input: "read" or "refused", else what is wrong."""

    kind: str
    seed: int
    outcome: str
    fault: str = ""
    seconds: float = 0.0
    peak: int = 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--inputs", type=int, default=2000, help="how many, over all kinds")
    parser.add_argument(
        "--seed", type=int, help="of the first input; drawn and printed if left out"
    )
    parser.add_argument("--kind", help="only inputs of this kind")
    parser.add_argument("--only", nargs=2, metavar=("KIND", "SEED"), help="one input, again")
    parser.add_argument("--out", type=Path, help="results as JSON lines")
    options = parser.parse_args()
    if options.only:
        print(attack(options.only[0], range(int(options.only[1]), int(options.only[1]) + 1)))
        return 0
    first = random.SystemRandom().randrange(10**9) if options.seed is None else options.seed
    print(f"seed {first}", flush=True)
    from kinds import KINDS

    # compiled before the clock of an input runs
    vt.simulate(vt.Scenario.load("position_sine", {"run.settle": 0.1, "run.duration": 0.1}))
    chosen = [k for k in KINDS if options.kind in (None, k.name)]
    whole = sum(kind.share for kind in chosen)
    found: list[Outcome] = []
    for kind in chosen:
        count = max(round(options.inputs * kind.share / whole), 1)
        found += attack(kind.name, range(first, first + count))
        print(line(kind.name, [o for o in found if o.kind == kind.name]), flush=True)
    if options.out:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        rows = "".join(json.dumps(asdict(one)) + "\n" for one in found)
        options.out.write_text(rows, encoding="utf-8")
    print(line("all", found))
    faults = [one for one in found if one.fault]
    for one in faults:
        print(f"FAULT {one.kind} {one.seed}: {one.fault}")
    return 1 if faults else 0


def line(name: str, found: list[Outcome]) -> str:
    """Figures of one kind."""
    counts = Counter(one.outcome for one in found)
    slow = max((one.seconds for one in found), default=0.0)
    peak = max((one.peak for one in found), default=0)
    faults = sum(bool(one.fault) for one in found)
    return (
        f"{name:20} {len(found):6} inputs, {counts['read']:6} read, {counts['refused']:6} refused,"
        f" {faults:4} faults, longest {slow:5.1f} s, most {peak / 1e6:4.0f} MB"
    )


def attack(name: str, seeds: range, use: Callable[[Path], object] | None = None) -> list[Outcome]:
    """Outcomes of inputs of one kind, each in a child that may die.

    Args:
        name: of the kind.
        seeds: one for each input.
        use: in place of what a user does with such a file, for tests of this program.
    """
    import kinds  # noqa: F401  here, so that no child must import it anew

    found: list[Outcome] = []
    left = list(seeds)
    while left:
        part = left[:EACH]
        with tempfile.TemporaryDirectory() as folder:  # of the parent: a child may be killed
            done = list(_in_child(name, part, use, folder))
        found += done
        left = left[len(done) :]
    return found


def _in_child(name: str, seeds: list[int], use: object, folder: str) -> Iterator[Outcome]:
    """Outcomes until the child is through or dies; whom it died of comes last."""
    here, there = mp.Pipe(duplex=False)
    child = mp.get_context("fork").Process(target=_work, args=(there, name, seeds, use, folder))
    child.start()
    there.close()
    try:
        for seed in seeds:
            if not here.poll(SECONDS):
                yield Outcome(name, seed, "hung", f"no answer within {SECONDS:g} s", SECONDS)
                return
            try:
                yield here.recv()
            except EOFError:
                child.join()
                yield Outcome(name, seed, "died", f"the process ended with code {child.exitcode}")
                return
    finally:
        child.kill()
        child.join()


def _work(pipe: Connection, name: str, seeds: list[int], use: object, folder: str) -> None:
    from kinds import KINDS

    kind = next(k for k in KINDS if k.name == name)
    resource.setrlimit(resource.RLIMIT_AS, (8 * MEMORY, 8 * MEMORY))  # it spares the machine
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryFile() as said:
        os.chdir(folder)
        os.dup2(said.fileno(), 2)
        for seed in seeds:
            path = Path(folder) / name
            try:
                path.write_bytes(kind.draw(random.Random(f"{name} {seed}")))
            except Exception as error:
                pipe.send(Outcome(name, seed, "no input", f"{error!r:.200}; {_where(error)}"))
                continue
            pipe.send(_one(name, seed, path, use or kind.use))
        os.chdir("/")


def _one(name: str, seed: int, path: Path, use: Callable[[Path], object]) -> Outcome:
    before, told = os.fstat(2).st_size, ""
    _forget_peak()
    warm = _peak()
    begin, outcome, fault = time.monotonic(), "read", ""
    with warnings.catch_warnings(record=True) as noted:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", VesTwinWarning)  # a line of our own for the user
        try:
            use(path)
        except BaseException as error:
            outcome, told = type(error).__name__, str(error)
            if _is_refusal(error):
                outcome = "refused"
            else:
                fault = f"{outcome}: {told[:200]}; {_where(error)}"
    seconds = time.monotonic() - begin
    peak = min(warm, PROGRAM) + _peak() - warm
    sys.stderr.flush()
    if os.fstat(2).st_size > before:
        fault = fault or f"on stderr: {_tail(os.fstat(2).st_size - before)}"
    if outcome == "refused" and ("\n" in told or not 0 < len(told) < LONGEST):
        fault = fault or f"{len(told)} characters: {told[:200]!r}"
    if outcome == "read" and noted:
        fault = fault or f"warns: {noted[0].category.__name__} {noted[0].message}, {noted[0].filename}:{noted[0].lineno}"  # fmt: skip
    left = sorted(p.name for p in path.parent.iterdir() if not p.name.startswith(name))
    if left:
        fault = fault or f"left {left[:3]}"
        for other in left:
            (path.parent / other).unlink()
    if peak > MEMORY:
        fault = fault or f"{peak / 1e6:.0f} MB"
    return Outcome(name, seed, outcome, fault, round(seconds, 3), peak)


def _is_refusal(error: BaseException) -> bool:
    return isinstance(error, VesTwinError)


def _where(error: BaseException) -> str:
    own = [
        f for f in traceback.extract_tb(error.__traceback__) if "site-packages" not in f.filename
    ]
    return " < ".join(f"{Path(f.filename).name}:{f.lineno}" for f in reversed(own[-3:]))


def _tail(size: int) -> str:
    content = os.pread(2, size, os.fstat(2).st_size - size)
    return content.decode("utf-8", "replace")[-300:].replace("\n", " | ")


def _forget_peak() -> None:
    """From here on VmHWM counts anew (proc(5), clear_refs)."""
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def _peak() -> int:
    words = Path("/proc/self/status").read_text(encoding="ascii", errors="replace").split()
    return 1024 * int(words[words.index("VmHWM:") + 1])


if __name__ == "__main__":
    sys.exit(main())
