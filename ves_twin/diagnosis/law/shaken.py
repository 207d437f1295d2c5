"""shaken, none_beside: proved names whose work a law does, too."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from ves_twin.diagnosis.build_up.report import SHAKEN
from ves_twin.diagnosis.build_up.result import Proved
from ves_twin.diagnosis.law.result import LawFinding
from ves_twin.effects.law import joints_of


def shaken(
    proved: Sequence[Proved], law: LawFinding | None, none_beside: Collection[str] = ()
) -> tuple[Proved, ...]:
    """What is proved, with no firm name where a law of what is left shakes it.

    Unmodelled physics at a joint looks in part like any cause there: hysteresis stiffens, so that a
    cubic spring improves the prediction. A law that a search found there, claimed or not, with a
    gain on held-out data that is clear of zero, shakes a name from SHAKEN of its amplitude on. So
    does any claimed law beside which a cause may as well be none: it does the cause's work, too.

    Args:
        proved: causes, with what each takes from channels on held-out data.
        law: the nearest one of what they leave; None if nobody looked.
        none_beside: labels of causes that may be none where they were fitted together with it.
    """
    if law is None or not law.part or law.gain is None or (law.gain.low or 0.0) <= 0.0:
        return tuple(proved)
    share, joints = law.gain.low or 0.0, {name for name, _ in joints_of(law.place)}
    found = []
    for one in proved:
        there = {name for name, _ in joints_of(one.target)} <= joints
        before, after = max(one.takes.values(), key=lambda ends: ends[0] ** 2 - ends[1] ** 2)
        more = share * after**2 > SHAKEN**2 * (before**2 - after**2)
        stands = one.label not in none_beside and not (there and more)
        found.append(replace(one, firm=one.firm and stands))
    return tuple(found)


def none_beside(
    proved: Sequence[Proved],
    tuned: Mapping[str, tuple[float, float]],
    nominal: Mapping[str, float],
) -> list[str]:
    """Labels of causes of which no size is clear of what the model has, beside a law.

    Args:
        proved: causes.
        tuned: ends of the interval of each number that was fitted together with the law.
        nominal: value of each parameter in the model as it was given.
    """
    found = []
    for one in proved:
        sizes = [name for name in tuned if name.rpartition(":")[0] == one.label]
        if sizes and all(tuned[n][0] <= nominal[n] <= tuned[n][1] for n in sizes):
            found.append(one.label)
    return found
