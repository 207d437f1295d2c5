"""Laws that no library has, hidden in a machine, and what a diagnosis makes of them: counts.

python benchmarks/laws.py [--machine pendulum] [--each 1] [--none 4] [--library 4] [--seed N]
    [--workers 2] [--out runs/laws]

Recordings go to the folder, truths beside it; the diagnosis reads the folder alone.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ves_twin.cli.given import bank_settings
from ves_twin.suites.law_suite import (
    IN_ORDER,
    LIBRARY,
    MACHINE,
    LawAnswer,
    LawScore,
    answer_laws,
    hidden_kinds,
    make_laws,
    read_law_truths,
    score_law,
    truth_file,
)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--each", type=int, default=1, help="cases of each kind outside the library"
    )
    parser.add_argument("--none", type=int, default=4, help="machines in order")
    parser.add_argument("--library", type=int, default=4, help="machines with a library cause")
    parser.add_argument("--kinds", nargs="*", help="default: all of the machine")
    parser.add_argument("--machine", default=MACHINE, help="a name, or the file of an MJCF machine")
    parser.add_argument("--seed", type=int, default=int(np.random.SeedSequence().entropy) % 10**6)
    parser.add_argument("--workers", type=int, default=bank_settings().workers, help="processes")
    parser.add_argument("--out", type=Path, default=Path("runs/laws"))
    told = parser.parse_args(arguments)
    told.kinds = told.kinds or hidden_kinds(told.machine)
    kinds = [*(told.each * told.kinds), *[IN_ORDER] * told.none, *[LIBRARY] * told.library]
    if not truth_file(told.out).is_file():
        make_laws(kinds, told.out, told.seed, told.machine)
    settings = replace(bank_settings(), laws=True, workers=told.workers)
    answers = answer_laws(told.out, settings, _say, told.machine)
    truths = [truth for truth in read_law_truths(told.out) if truth.case in answers]
    scores = [score_law(truth, answers[truth.case]) for truth in truths]
    print("\n".join(table(scores)))


def _say(case: str, answer: LawAnswer) -> None:
    law = answer.law or {}
    found = f"{law.get('place')}{law.get('of')} {law.get('form')}" if law else ""
    print(f"{case} {answer.verdict} {found} {law.get('reason', '')}", file=sys.stderr, flush=True)


def table(scores: Sequence[LawScore]) -> list[str]:
    """Markdown: one row for each kind, then the counts."""
    rows = [
        "| hidden | cases | unknown | place and variable | claimed | gain | error of the law |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in dict.fromkeys(s.kind for s in scores):
        own = [s for s in scores if s.kind == kind]
        right = sum(s.place is True for s in own)
        known = any(s.place is not None for s in own)
        rows.append(
            f"| {kind.replace('_', ' ')} | {len(own)} | {sum(s.verdict == 'unknown' for s in own)}"
            f" | {right if known else ''} | {sum(s.claimed for s in own)}"
            f" | {_few([s.gain for s in own if s.claimed])} | {_few([s.rms for s in own])} |"
        )
    hidden = [s for s in scores if s.place is not None]
    asked = [s for s in hidden if s.verdict == "unknown"]
    others = [s for s in scores if s.place is None]
    wrong = sum(s.claimed and s.place is False for s in hidden)
    covered = [s.covered for s in scores if s.covered is not None]
    rows += [
        "",
        f"hidden laws: {len(hidden)}; a law was looked for in {len(asked)}, place and variable"
        f" right in {sum(s.place is True for s in asked)}, claimed {sum(s.claimed for s in asked)},"
        f" of those {wrong} at a wrong place or of a wrong variable",
        f"no law hidden: {len(others)}; laws claimed: {sum(s.claimed for s in others)}",
        f"band holds the truth at {_few([float(np.mean(covered))] if covered else [])} of its"
        f" places ({len(covered)} laws)",
        f"processor time a case: median {np.median([s.seconds for s in scores]):.0f} s, most"
        f" {max(s.seconds for s in scores):.0f} s",
    ]
    return rows


def _few(values: Sequence[float | None]) -> str:
    return ", ".join(f"{v:.2f}" for v in values if v is not None) or "-"


if __name__ == "__main__":
    main()
