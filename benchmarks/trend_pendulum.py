"""Series of blind pendulums through the trend: counts beside the stated rate, as the end of a page.

    python benchmarks/trend_pendulum.py docs/trend.md [--series 60] [--rate 0.05]

Everything below the line `## Measured on the pendulum` is written anew.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.stats import binomtest

from ves_twin.core.recording.recording import Recording
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.trend.calendar import Calendar
from ves_twin.diagnosis.trend.result import Answer, Trend
from ves_twin.diagnosis.trend.trend import trend
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.machines import machine_of

MARK = "## Measured on the pendulum"
MACHINE = machine_of("pendulum")
FORWARD = MACHINE.forward
FRICTION, DAMPING = "coulomb_friction@joint:level", "viscous_friction@joint:damping"
DAYS = (0.0, 3.0, 7.0, 10.0, 14.0, 17.0)
CHANGED = (Answer.STEP, Answer.RAMP, Answer.VARIES)


@dataclass(frozen=True)
class Case:
    """What is hidden in a series: a number of the rig by day, and days of a second rig."""

    name: str
    parameter: str
    size: Callable[[float], float]
    right: tuple[Answer, ...]
    other: tuple[int, ...] = ()
    share: float = 0.2


CASES = (
    Case("nothing", FRICTION, lambda _: 0.0, (Answer.NOTHING,), share=1.0),
    Case("dry friction, constant", FRICTION, lambda _: 0.004, (Answer.CONSTANT,)),
    Case("dry friction from day 10 on", FRICTION, lambda d: 0.002 * (d >= 10), CHANGED[:1]),
    Case(
        "dry friction growing from day 5 on",
        FRICTION,
        lambda d: 0.0003 * max(d - 5.0, 0.0),
        CHANGED[1:2],
    ),
    Case(
        "two sd of damping from day 10 on",
        DAMPING,
        lambda d: 0.002 * (d >= 10),
        CHANGED[:1],
    ),
    Case("two rigs", FRICTION, lambda _: 0.0, (Answer.MIXED,), other=(1, 4)),
)


def series(case: Case, seed: int) -> list[Recording]:
    """One rig, its start and its drive's zero drawn anew each day; some days another rig."""
    rng = np.random.default_rng([seed, 77])
    rigs = [MACHINE.commissioned(rng) for _ in range(2)]
    daily = [p for p in FORWARD.parameters if p.per_recording]
    found = []
    for k, day in enumerate(DAYS):
        values = dict(rigs[k in case.other])
        values |= {p.name: p.nominal + p.sd * rng.standard_normal() for p in daily}
        nominal = next(p.nominal for p in FORWARD.parameters if p.name == case.parameter)
        values[case.parameter] = values.get(case.parameter, nominal) + case.size(day)
        found.append(MACHINE.record(BlindRig(values), "train", rng))
    return found


def right(case: Case, found: Trend) -> bool:
    """The answer, and where a cause is named the hidden one among its equals."""
    if found.answer not in case.right:
        return False
    if found.cause is None or found.answer is Answer.MIXED:
        return True
    hidden = {h.label for h in FORWARD.hypotheses if case.parameter in h.parameters}
    return bool(hidden & {found.cause.label, *found.cause.equals})


def dated(case: Case, found: Trend) -> bool | None:
    """Whether the onset's interval holds the true one; None where there is none."""
    if found.change is None or found.change.onset is None or found.answer not in case.right:
        return None
    onset = 5.0 if found.answer is Answer.RAMP else 10.0
    return found.change.onset.low <= onset <= found.change.onset.high


def measured(count: int, rate: float) -> list[str]:
    """The rows of the table."""
    calendar, lines = Calendar(None, DAYS), []
    with TemporaryDirectory() as folder:
        settings = Settings(nulls=100, cache=Path(folder), candidates=3)
        for case in CASES:
            number, begin = max(1, round(case.share * count)), time.process_time()
            said = [
                trend(
                    MACHINE.forward, series(case, s), calendar, false_alarm=rate, settings=settings
                )
                for s in range(number)
            ]
            hits = sum(right(case, one) for one in said)
            held = [h for one in said if (h := dated(case, one)) is not None]
            others = Counter(one.answer.value for one in said if not right(case, one))
            told = ", ".join(f"{n} {answer}" for answer, n in others.most_common()) or "-"
            dates = f"{sum(held)}/{len(held)}" if held else "-"
            each = (time.process_time() - begin) / number
            hit = f"{hits}/{number} ({_wilson(hits, number)})"
            row = f"| {case.name} | {number} | {hit} | {dates} | {told} | {each:.1f} |"
            lines.append(row)
            print(row, flush=True)
            if case.name == "nothing":
                alarms = sum(one.answer in CHANGED for one in said)
                lines.insert(0, f"{alarms} of {number} ({_wilson(alarms, number)})")
    return lines


def _wilson(hits: int, count: int) -> str:
    ends = binomtest(hits, count).proportion_ci(0.95, "wilson")
    return f"{ends.low:.2f}-{ends.high:.2f}"


HEAD = """\
Six recordings of 4 s over 17 days, one programme, a stated rate of {rate:g}. Measured pendulums are
those of the blind suite: Runge-Kutta at half the step, noise of another level and colour, a
counting encoder, a torque disturbance that no model has; commissioning errors once for each rig,
start and zero of the drive anew each day. Intervals of rates: 95 %, Wilson.
"""


def page(count: int, rate: float) -> str:
    command = f"benchmarks/trend_pendulum.py docs/trend.md --series {count} --rate {rate:g}"
    alarms, *rows = measured(count, rate)
    lines = [
        MARK,
        "",
        f"Written by `.venv/bin/python {command}`.",
        "",
        HEAD.format(rate=rate),
        f"Called changed with nothing changed: {alarms}, stated {rate:g}.",
        "",
        "| hidden | series | right | onset in its interval | other answers | cpu s a series |",
        "|---|--:|---|---|---|--:|",
        *rows,
        "",
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("--series", type=int, default=60)
    parser.add_argument("--rate", type=float, default=0.05)
    arguments = parser.parse_args()
    text = arguments.page.read_text(encoding="utf-8").split(MARK)[0]
    arguments.page.write_text(text + page(arguments.series, arguments.rate), encoding="utf-8")


if __name__ == "__main__":
    main()
