"""with_one_way_twins: proved causes with those that only a reversal would tell them from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.result import Proved
from ves_twin.diagnosis.model.directional import Directional
from ves_twin.diagnosis.record.runs import Runs


def with_one_way_twins(
    proved: Sequence[Proved],
    halves: Halves,
    points: tuple[FloatArray, FloatArray] | None = None,
) -> tuple[Proved, ...]:
    """With what each acts like beside that, and not firm, where its joint keeps one direction.

    Dry friction and a constant force are one there, whichever of them is offered: Coulomb friction
    of a youBot was firm where no offset was offered, and the offset where no friction was.

    Args:
        proved: causes.
        halves: with the recordings of both halves.
        points: departures in each half (coordinates,); none if None.
    """
    runs = halves.regression.half.runs, halves.held.runs
    same = runs[0].programmes is runs[1].programmes
    ends = points or (runs[0].origin, runs[1].origin)
    places = list(zip(runs, ends, strict=True))[: 1 if same else 2]
    twins = one_way_twins([one.label for one in proved], places)
    found = []
    for one in proved:
        like = twins.get(one.label, ())
        acts = tuple(dict.fromkeys([*one.acts_like, *like]))
        firm = one.firm and not like
        found.append(replace(one, acts_like=acts, firm=firm, one_way=bool(like)))
    return tuple(found)


def one_way_twins(
    labels: Sequence[str], places: Sequence[tuple[Runs, FloatArray]]
) -> Mapping[str, tuple[str, ...]]:
    """What nothing tells from causes in recordings, themselves left out, by label.

    Args:
        labels: of the causes.
        places: recordings, with the departures (coordinates,) at which they are simulated.
    """
    forward = places[0][0].forward
    if not labels or not isinstance(forward, Directional):
        return {}
    moments = [
        (programme, runs.values(k, point))
        for runs, point in places
        for k, programme in enumerate(runs.programmes)
    ]
    known = forward.one_way_twins(sorted(labels), moments)
    others = {label: tuple(n for n in names if n not in labels) for label, names in known.items()}
    return {label: names for label, names in others.items() if names}
