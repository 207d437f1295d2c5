"""Blind pendulums through the diagnosis: counts with Wilson intervals, as the end of a page.

    python benchmarks/diagnosis_pendulum.py docs/diagnosis.md [--cases 200]

Everything below the line `## Measured on the pendulum` is written anew.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
from scipy.stats import binomtest

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "benches"))

from blind import Outside, blind_record, programme_rows
from rows import PEER, ROWS, row_record

from ves_twin.benches.pendulum import STEP, Pendulum
from ves_twin.diagnosis.detectability import detectability
from ves_twin.diagnosis.diagnose import diagnose
from ves_twin.diagnosis.forward import Programme
from ves_twin.diagnosis.linearise import linearise
from ves_twin.diagnosis.runs import Runs
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict import Kind, Verdict
from ves_twin.diagnosis.whitening import whitening_declared

PLANT = Pendulum()
TORQUE = programme_rows(1)
MARK = "## Measured on the pendulum"
OUTSIDE = (
    Outside(drag=0.004),
    Outside(tilt=0.03),
    Outside(drift=0.02),
    Outside(drag=0.02),
    Outside(drift=-0.05),
)


class Bench:
    """The pendulum under one programme, and how to size an effect in sigma."""

    def __init__(self, cache: Path) -> None:
        rows = STEP * np.arange(len(TORQUE))
        fed = Programme("multisine", rows, {"joint.torque": TORQUE[:, None]})
        self.runs = Runs(PLANT, (fed,), (0, 1))
        self.local = linearise(self.runs, self.runs.origin)
        self.whitening = whitening_declared(self.runs)
        self.settings = Settings(nulls=100, cache=cache)

    def sized(self, number: int, sign: int, d: float) -> tuple[str, float]:
        """Departure of a cause that has a given d, by secants in the logarithm."""
        cause = PLANT.hypotheses[number]
        where = self.runs.indices(cause)
        size = cause.smallest[0]
        for _ in range(5):
            shift = self.runs.depart(self.runs.origin, where, np.array([sign * size]))
            size *= float(np.clip(d / detectability(self.local, self.whitening, shift), 0.2, 5))
        return cause.parameters[0], sign * size

    def verdict(self, seed: int, **what: object) -> tuple[Verdict, float]:
        record = blind_record(np.random.default_rng(seed), TORQUE, **what)  # type: ignore[arg-type]
        start = time.process_time()
        return diagnose(PLANT, [record], settings=self.settings), time.process_time() - start


def share(right: int, n: int) -> str:
    if not n:
        return "-"
    ends = binomtest(right, n).proportion_ci(0.95, "wilson")
    return f"{right}/{n} ({ends.low:.2f}-{ends.high:.2f})"


def peer_rows(settings: Settings) -> list[str]:
    lines = [
        "| hidden | mujoco.sysid 4.0.0 (quoted) | verdict | size found | hidden size |",
        "|---|---|---|---|---|",
    ]
    for name, (hidden, told) in ROWS.items():
        v = diagnose(PLANT, [row_record(hidden)], settings=settings)
        found = [p.words for c in v.causes for p in c.parameters.values()]
        names = ", ".join(c.effect for c in v.causes)
        lines.append(
            f"| {name} | {PEER[name]} | {v.verdict} {names} | {', '.join(found) or '-'} | {told} |"
        )
        print(lines[-1], file=sys.stderr, flush=True)
    return lines


KINDS = ("none", "d 6-10", "none", "d 10-20", "outside", "d 10-20", "pair", "d 6-10")


class Tally:
    """Answers by kind of case."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.rng = np.random.default_rng(11)
        self.said: dict[str, Counter[str]] = {kind: Counter() for kind in KINDS}
        self.covered: list[bool] = []
        self.firm: list[bool] = []
        self.cpu: list[float] = []
        self.other: list[str] = []

    def case(self, seed: int) -> None:
        kind = KINDS[seed % len(KINDS)]
        hidden, truth = self.hide(kind)
        outside = OUTSIDE[seed // len(KINDS) % len(OUTSIDE)] if kind == "outside" else None
        v, seconds = self.bench.verdict(seed, hidden=hidden, outside=outside)
        self.cpu.append(seconds)
        answer = judge(v, truth)
        self.said[kind][answer] += 1
        if answer != ("nothing" if kind == "none" else "right"):
            what = ", ".join(f"{k} {x:+.3g}" for k, x in hidden.items()) or str(outside or "-")
            self.other.append(f"{kind}: {what} -> {v.words}")
            print(self.other[-1], file=sys.stderr, flush=True)
        if answer == "right" and len(truth) == 1:
            p = next(iter(v.causes[0].parameters.values()))
            self.covered.append(p.low <= p.nominal + next(iter(hidden.values())) <= p.high)
            self.firm.append(v.causes[0].firm)

    def hide(self, kind: str) -> tuple[dict[str, float], list[str]]:
        hidden, truth = {}, []
        count = {"none": 0, "outside": 0, "pair": 2}.get(kind, 1)
        for number in self.rng.choice(len(PLANT.hypotheses), count, replace=False):
            cause = PLANT.hypotheses[number]
            d = self.rng.uniform(6, 10) if kind == "d 6-10" else self.rng.uniform(10, 20)
            name, size = self.bench.sized(int(number), int(self.rng.choice(cause.signs)), d)
            hidden[name] = size
            truth.append(cause.effect)
        return hidden, truth


def judge(v: Verdict, truth: list[str]) -> str:
    names = [c.effect for c in v.causes]
    if v.verdict is Kind.AMBIGUOUS:
        groups = [{names[i] for i in a} for a in v.alternatives]
        return "ambiguous, truth inside" if set(truth) in groups else "ambiguous, truth outside"
    if not names:
        return str(v.verdict)
    if len(truth) == 2 and len(names) == 1 and names[0] in truth:
        return "one of the two"
    return "right" if sorted(names) == sorted(truth) else "wrong"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("page", type=Path)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--cache", type=Path, default=Path("runs/banks"))
    options = parser.parse_args()
    bench = Bench(options.cache)
    table = peer_rows(bench.settings)
    tally = Tally(bench)
    for seed in range(1000, 1000 + options.cases):
        tally.case(seed)
    page = options.page.read_text(encoding="utf-8") if options.page.exists() else f"{MARK}\n"
    text = "\n".join(measured(table, tally, options.cases))
    options.page.write_text(page.split(MARK)[0] + text, encoding="utf-8")


def measured(table: list[str], tally: Tally, cases: int) -> list[str]:
    said, covered, cpu = tally.said, tally.covered, tally.cpu
    lines = [
        MARK,
        "",
        "Written by `.venv/bin/python benchmarks/diagnosis_pendulum.py docs/diagnosis.md --cases"
        f" {cases}`.",
        "",
        "The six rows of the peers' table, data made as theirs (8 s, 500 Hz, same integrator):",
        "",
        *table,
        "",
        "Blind cases: 4 s of multisine; data by Runge-Kutta at half the step, all commissioning"
        " parameters redrawn, noise of other level and colour, counting encoder, a torque"
        " disturbance. Library of 8 causes; d is the size in sigma with nuisances marginalised.",
        "",
        "| hidden | n | right | other answers |",
        "|---|---|---|---|",
    ]
    for kind in ("none", "d 6-10", "d 10-20", "pair", "outside"):
        counts = said.get(kind, Counter())
        n = sum(counts.values())
        wanted = {"none": "nothing", "outside": "unknown"}.get(kind, "right")
        rest = ", ".join(f"{v} {k}" for k, v in counts.most_common() if k != wanted) or "-"
        lines.append(f"| {kind} | {n} | {share(counts[wanted], n)} | {rest} |")
    lines += [
        "",
        f"90 % intervals hold the hidden size in {share(sum(covered), len(covered))} of the right"
        f" names; {sum(tally.firm)} of those {len(tally.firm)} names are firm.",
        f"Processor time of one diagnosis with the bank cached: median {np.median(cpu):.1f} s,"
        f" longest {np.max(cpu):.1f} s.",
        "",
        "Wrong or withheld names, and what was said of effects outside the library:",
        "",
        *(f"- {text}" for text in tally.other),
        "",
    ]
    return lines


if __name__ == "__main__":
    main()
