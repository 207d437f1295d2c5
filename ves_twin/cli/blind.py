"""blind: make a suite with hidden effects, diagnose it from the recordings alone, mark answers."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ves_twin.blind.mark import Marks

SUMMARY = "hide effects in recordings, answer from the recordings alone, mark anybody's answers"

QUICK = {"none": 6, "single": 10, "outside": 4, "pair": 2, "confusable": 0}
"""Cases of each sort if nothing is said."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the three verbs."""
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    make = verbs.add_parser("make", help="write recordings, and the sealed truth beside them")
    make.add_argument("--bench", default="pendulum", help="pendulum, ves2_fast or ves2")
    make.add_argument("--cases", metavar="N", type=int, help="so many single causes and no more")
    for sort, count in QUICK.items():
        make.add_argument(f"--{sort}", metavar="N", type=int, help=f"cases (default: {count})")
    make.add_argument("--spread", type=float, default=1.0, help="commissioning errors, declared sd")
    make.add_argument("--seed", type=int, help="of all draws (default: the system's randomness)")
    answer = verbs.add_parser("answer", help="diagnose the cases that have no answer yet")
    answer.add_argument("--nulls", type=int, default=60, help="rigs of the null distribution")
    score = verbs.add_parser("score", help="mark answers")
    score.add_argument("--page", metavar="FILE", help="write the marks as a page, too")
    score.add_argument("--json", action="store_true", help="the marks as JSON on stdout")
    reveal = verbs.add_parser("reveal", help="open the seal: what was hidden, case by case")
    for verb in (make, answer, score, reveal):
        verb.add_argument("--out", metavar="DIR", default="runs/blind", help="folder of the suite")
    for verb in (make, score, reveal):
        verb.add_argument("--key", metavar="FILE", help="key of the seal (default: DIR.key)")
    for verb in (answer, score):
        verb.add_argument("--answers", metavar="FILE", help="answers (default: DIR.answers.json)")


def execute(arguments: argparse.Namespace) -> int:
    """Carry one of the verbs out."""
    folder = Path(arguments.out)
    if arguments.verb == "make":
        return _make(arguments, folder, _beside(folder, arguments.key, ".key"))
    if arguments.verb == "reveal":
        return _reveal(folder, _beside(folder, arguments.key, ".key"))
    answers = _beside(folder, arguments.answers, ".answers.json")
    if arguments.verb == "answer":
        return _answer(folder, answers, arguments.nulls)
    return _score(arguments, folder, _beside(folder, arguments.key, ".key"), answers)


def _beside(folder: Path, given: str | None, ending: str) -> Path:
    return Path(given) if given else folder.with_name(folder.name + ending)


def _make(arguments: argparse.Namespace, folder: Path, key: Path) -> int:
    import secrets

    from ves_twin.blind.make import make_suite
    from ves_twin.blind.truth import Hidden
    from ves_twin.cli.progress import RunProgress

    counts = {sort: getattr(arguments, sort) for sort in QUICK}
    if arguments.cases is not None:
        counts = {sort: counts[sort] or 0 for sort in QUICK} | {"single": arguments.cases}
    asked = {
        Hidden(sort): QUICK[sort] if count is None else count for sort, count in counts.items()
    }
    seed = secrets.randbelow(2**31) if arguments.seed is None else arguments.seed
    with RunProgress("blind make", 1.0, unit="share") as progress:
        suite = make_suite(
            arguments.bench,
            asked,
            folder,
            key,
            seed,
            progress.share,
            arguments.spread,
            os.cpu_count() or 1,
        )
    print(f"{len(suite.cases)} cases in {folder}/, key in {key}")
    return 0


def _answer(folder: Path, answers: Path, nulls: int) -> int:
    from ves_twin.blind.answer import answer_suite
    from ves_twin.cli.progress import RunProgress
    from ves_twin.compiled import cache_folder
    from ves_twin.diagnosis.settings import Settings

    cache = cache_folder().parent / "banks"
    settings = Settings(workers=os.cpu_count() or 1, cache=cache, nulls=nulls)
    with RunProgress("blind answer", 1.0, unit="share") as progress:
        found = answer_suite(folder, answers, settings, progress.share)
    print(f"{len(found)} answers in {answers}")
    return 0


def _reveal(folder: Path, key: Path) -> int:
    from ves_twin.blind.mark import read_truths

    for truth in read_truths(folder, _read_key(key)):
        hidden = [
            f"{cause.label} ({', '.join(f'{v:.4g}' for v in cause.departures.values())};"
            f" {cause.d:.1f} sigma)"
            for cause in truth.causes
        ]
        if truth.outside:
            hidden.append(f"{truth.outside} ({truth.outside_size:.3g}), outside the library")
        print(f"{truth.case}  {' and '.join(hidden) or 'nothing'}")
    return 0


def _read_key(key: Path) -> str:
    from ves_twin.errors import FileAccessError

    try:
        return key.read_text(encoding="utf-8").strip()
    except OSError as error:
        raise FileAccessError(f"cannot read the key {key}: {error.strerror}") from None


def _score(arguments: argparse.Namespace, folder: Path, key: Path, answers: Path) -> int:
    from ves_twin.blind.answer import read_answers
    from ves_twin.blind.mark import mark, read_truths

    marks = mark(read_truths(folder, _read_key(key)), read_answers(answers))
    if arguments.page:
        Path(arguments.page).write_text(_text(marks), encoding="utf-8")
    if arguments.json:
        rows = {name: {"hits": r.hits, "of": r.of} for name, r in marks.rows.items()}
        print(json.dumps({"rows": rows, "seconds": dict(marks.seconds)}, indent=1))
    else:
        print(_text(marks))
    return 0


def _text(marks: Marks) -> str:
    lines = ["| counted | hits of cases (share; 95 % Wilson) |", "|---|---|"]
    lines += [f"| {name} | {rate} |" for name, rate in marks.rows.items()]
    if marks.coverage.of:
        lines.append(f"| 90 % intervals that hold the hidden size | {marks.coverage} |")
    lines += [
        f"| stated probability {span}: right | {r} |" for span, r in marks.reliability.items()
    ]
    if marks.confusions:
        lines += ["", "| hidden | said instead | times |", "|---|---|--:|"]
        lines += [f"| {t} | {said} | {n} |" for (t, said), n in sorted(marks.confusions.items())]
    times = ", ".join(f"{sort} {seconds:.0f} s" for sort, seconds in marks.seconds.items())
    return "\n".join([*lines, "", f"Median time of a diagnosis: {times}.", ""])
