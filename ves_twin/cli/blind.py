"""blind: make a suite with hidden effects, diagnose it from the recordings alone, score it."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

from ves_twin.core.json_text import json_text

if TYPE_CHECKING:
    from ves_twin.suites.answers import Answer
    from ves_twin.suites.recipe import Recipe
    from ves_twin.suites.score import Scores
    from ves_twin.suites.score_next import NextScores
    from ves_twin.suites.truth import Truth

SUMMARY = "hide effects in recordings, answer from the recordings alone, score anybody's answers"

QUICK = {"none": 6, "single": 10, "outside": 4, "pair": 2, "confusable": 0, "edited": 0, "many": 0}
"""Cases of each sort if nothing is said."""


_COVER = "90 % intervals that hold the hidden size"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the five verbs."""
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    make = verbs.add_parser("make", help="write recordings, and the sealed truth beside them")
    _add_recipe(make)
    answer = verbs.add_parser("answer", help="diagnose the cases that have no answer yet")
    answer.add_argument("--nulls", type=int, default=60, help="rigs of the null distribution")
    answer.add_argument(
        "--workers", metavar="N", type=int, default=os.cpu_count() or 1, help="processes"
    )
    answer.add_argument(
        "--no-commissioning", action="store_true", help="without the recordings of other rigs"
    )
    answer.add_argument(
        "--no-baseline", action="store_true", help="without those of the same rig in order"
    )
    answer.add_argument(
        "--after",
        metavar="CHOICE",
        help="with the next experiment that was played: proposed or random",
    )
    play = verbs.add_parser("play", help="record the next experiment of ambiguous cases")
    play.add_argument("--choice", default="proposed", help="proposed (default) or random")
    score = verbs.add_parser("score", help="score answers")
    score.add_argument("--page", metavar="FILE", help="write the scores as a page, too")
    score.add_argument("--json", action="store_true", help="the scores as JSON on stdout")
    score.add_argument(
        "--against", metavar="FILE", help="other answers: how many of their firm names stay"
    )
    reveal = verbs.add_parser("reveal", help="open the seal: what was hidden, case by case")
    for verb in (make, answer, play, score, reveal):
        verb.add_argument("--out", metavar="DIR", default="runs/blind", help="folder of the suite")
    for verb in (make, play, score, reveal):
        verb.add_argument("--key", metavar="FILE", help="key of the seal (default: DIR.key)")
    for verb in (answer, play, score):
        verb.add_argument("--answers", metavar="FILE", help="answers (default: DIR.answers.json)")


def _add_recipe(make: argparse.ArgumentParser) -> None:
    make.add_argument(
        "--machine",
        "--bench",
        metavar="NAME|FILE",
        default="pendulum",
        help="pendulum, ves2_fast, ves2, or the TOML file of an MJCF machine",
    )
    make.add_argument("--cases", metavar="N", type=int, help="so many single causes and no more")
    for sort, count in QUICK.items():
        make.add_argument(f"--{sort}", metavar="N", type=int, help=f"cases (default: {count})")
    make.add_argument("--spread", type=float, default=1.0, help="commissioning errors, declared sd")
    make.add_argument("--seed", type=int, help="of all draws (default: the system's randomness)")
    make.add_argument(
        "--commissioned", metavar="N", type=int, default=0, help="recordings of N rigs in order"
    )
    make.add_argument(
        "--background",
        metavar="KIND=SIZE",
        action="append",
        default=[],
        help="every rig has this, which the library lacks",
    )
    make.add_argument(
        "--model-error",
        metavar="SHARE",
        type=float,
        default=0.0,
        help="rms of coloured error in every column, of its own; --many needs some",
    )
    for flag, words in {
        "baseline": "a recording of each rig before anything is hidden in it",
        "cut": "recordings cut out of a longer motion",
        "poor": "a first recording that tells little",
        "repaired": "held-out recordings after the effect was repaired",
    }.items():
        make.add_argument(f"--{flag}", action="store_true", help=words)


def execute(arguments: argparse.Namespace) -> int:
    """Carry one of the verbs out."""
    folder = Path(arguments.out)
    if arguments.verb == "make":
        return _make(arguments, folder, _beside(folder, arguments.key, ".key"))
    if arguments.verb == "reveal":
        return _reveal(folder, _beside(folder, arguments.key, ".key"))
    answers = _beside(folder, arguments.answers, ".answers.json")
    if arguments.verb == "answer":
        return _answer(arguments, folder, answers)
    key = _beside(folder, arguments.key, ".key")
    if arguments.verb == "play":
        return _play(folder, key, answers, arguments.choice)
    return _score(arguments, folder, key, answers)


def _beside(folder: Path, given: str | None, ending: str) -> Path:
    return Path(given) if given else folder.with_name(folder.name + ending)


def _make(arguments: argparse.Namespace, folder: Path, key: Path) -> int:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.held_folder import hold_folder
    from ves_twin.suites.make import make_suite

    recipe = _recipe(arguments)
    with hold_folder(folder), RunProgress("blind make", 1.0, unit="share") as progress:
        suite = make_suite(recipe, folder, key, progress.share, os.cpu_count() or 1)
    print(f"{len(suite.cases)} cases in {folder}/, key in {key}")
    return 0


def _recipe(arguments: argparse.Namespace) -> Recipe:
    from ves_twin.diagnosis.fit.tolerances import FEWEST, check_commissioned
    from ves_twin.suites.recipe import Recipe
    from ves_twin.suites.truth import Hidden

    counts = {sort: getattr(arguments, sort) for sort in QUICK}
    if arguments.cases is not None:
        counts = {sort: counts[sort] or 0 for sort in QUICK} | {"single": arguments.cases}
    asked = {
        Hidden(sort): QUICK[sort] if count is None else count for sort, count in counts.items()
    }
    check_commissioned(arguments.commissioned, FEWEST)
    return Recipe(
        arguments.machine,
        asked,
        arguments.seed,
        arguments.spread,
        arguments.commissioned,
        dict(_background(text) for text in arguments.background),
        arguments.baseline,
        arguments.cut,
        arguments.poor,
        arguments.repaired,
        arguments.model_error,
    )


def _background(text: str) -> tuple[str, float]:
    from ves_twin.core.errors import InvalidInputError

    kind, _, size = text.partition("=")
    try:
        return kind, float(size)
    except ValueError:
        raise InvalidInputError(
            "--background", text, "KIND=SIZE, for instance line=0.005"
        ) from None


def _answer(arguments: argparse.Namespace, folder: Path, answers: Path) -> int:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.cache_folder import cache_folder
    from ves_twin.core.held_folder import hold_file
    from ves_twin.diagnosis.settings import Settings
    from ves_twin.suites.answer import answer_suite
    from ves_twin.suites.material import Use

    use = Use(not arguments.no_commissioning, not arguments.no_baseline, arguments.after or "")
    if use.after and not arguments.answers:
        answers = _after(answers, use.after)
    cache = cache_folder("diagnosis")
    settings = Settings(workers=arguments.workers, cache=cache, nulls=arguments.nulls)
    with hold_file(answers), RunProgress("blind answer", 1.0, unit="share") as progress:
        found = answer_suite(folder, answers, settings, progress.share, use)
    print(f"{len(found)} answers in {answers}")
    return 0


def _after(answers: Path, choice: str) -> Path:
    """Answers of both recordings, beside those of the first."""
    return answers.with_name(f"{answers.stem}-{choice}.json")


def _play(folder: Path, key: Path, answers: Path, choice: str) -> int:
    from ves_twin.cli.progress import RunProgress
    from ves_twin.core.held_folder import hold_folder
    from ves_twin.suites.answers import read_answers
    from ves_twin.suites.play import play_next
    from ves_twin.suites.score import read_truths

    secret = _read_key(key)
    with hold_folder(folder), RunProgress("blind play", 1.0, unit="share") as progress:
        played = play_next(
            folder,
            secret,
            read_truths(folder, secret),
            read_answers(answers),
            choice,
            progress.share,
        )
    print(f"{len(played)} next experiments ({choice}) in {folder}/")
    return 0


def _reveal(folder: Path, key: Path) -> int:
    from ves_twin.suites.score import read_truths

    for truth in read_truths(folder, _read_key(key)):
        hidden = [
            f"{cause.label} ({', '.join(f'{v:.4g}' for v in cause.departures.values())};"
            f" {cause.d:.1f} sigma)"
            for cause in truth.causes
        ]
        if truth.outside:
            hidden.append(f"{truth.outside} ({truth.outside_size:.3g}), outside the library")
        if truth.family:
            hidden.append(f"error that is {truth.family}, outside the library")
        print(f"{truth.case}  {' and '.join(hidden) or 'nothing'}")
    return 0


def _read_key(key: Path) -> str:
    from ves_twin.core.errors import FileAccessError

    try:
        return key.read_text(encoding="utf-8").strip()
    except OSError as error:
        raise FileAccessError(f"cannot read the key {key}: {error.strerror}") from None


def _score(arguments: argparse.Namespace, folder: Path, key: Path, answers: Path) -> int:
    from ves_twin.core.whole_file import write_whole
    from ves_twin.suites.answers import read_answers
    from ves_twin.suites.score import read_truths, score
    from ves_twin.suites.score_gain import score_gain

    truths, given = read_truths(folder, _read_key(key)), read_answers(answers)
    other = read_answers(Path(arguments.against)) if arguments.against else None
    scores = score(truths, given, other)
    more = {name: rate for name, rate in score_gain(folder, truths, given).items() if rate.of}
    after = _next_scores(folder, truths, given, answers)
    more |= {name: rate for name, rate in after.rows.items() if rate.of} if after else {}
    scores = replace(scores, rows={**scores.rows, **more})
    text = _text(scores) + (_correlation(after) if after else "")
    if arguments.page:
        write_whole(Path(arguments.page), text)
    if arguments.json:
        counted = {**scores.rows, _COVER: scores.coverage}
        rows = {name: {"hits": r.hits, "of": r.of} for name, r in counted.items() if r.of}
        told = {"rows": rows, "seconds": dict(scores.seconds)}
        if after:
            told["correlation"] = None if isnan(after.correlation) else after.correlation
        print(json_text(told, indent=1))
    else:
        print(text)
    return 0


def _next_scores(
    folder: Path, truths: Sequence[Truth], given: Mapping[str, Answer], answers: Path
) -> NextScores | None:
    """Of the next experiments that were played and answered; None without."""
    from ves_twin.suites.answers import read_answers
    from ves_twin.suites.play import CHOICES, played_file
    from ves_twin.suites.score_next import score_next

    done = [c for c in CHOICES if _after(answers, c).is_file() and played_file(folder, c).is_file()]
    if not done:
        return None
    after = {choice: read_answers(_after(answers, choice)) for choice in done}
    played = {choice: json.loads(played_file(folder, choice).read_text()) for choice in done}
    return score_next(truths, given, after, played)


def _correlation(after: NextScores) -> str:
    return (
        f"\nPredicted and realised separation of the rivals (logarithms of chi^2):"
        f" correlation {after.correlation:.2f} over {len(after.points)} experiments.\n"
    )


def _text(scores: Scores) -> str:
    lines = ["| counted | hits of cases (share; 95 % Wilson) |", "|---|---|"]
    lines += [f"| {name} | {rate} |" for name, rate in scores.rows.items()]
    if scores.coverage.of:
        lines.append(f"| {_COVER} | {scores.coverage} |")
    lines += [
        f"| stated probability {span}: right | {r} |" for span, r in scores.reliability.items()
    ]
    if scores.confusions:
        lines += ["", "| hidden | said instead | times |", "|---|---|--:|"]
        lines += [f"| {t} | {said} | {n} |" for (t, said), n in sorted(scores.confusions.items())]
    times = ", ".join(f"{sort} {seconds:.0f} s" for sort, seconds in scores.seconds.items())
    return "\n".join([*lines, "", f"Median time of a diagnosis: {times}.", ""])
