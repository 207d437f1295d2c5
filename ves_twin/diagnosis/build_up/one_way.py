"""with_one_way_twins: proved causes with those that only a reversal would tell them from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.build_up.halves import Halves
from ves_twin.diagnosis.build_up.result import Proved
from ves_twin.diagnosis.model.directional import Directional


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
    forward = runs[0].forward
    if not proved or not isinstance(forward, Directional):
        return tuple(proved)
    same = runs[0].programmes is runs[1].programmes
    moments = [
        (programme, one.values(k, point))
        for one, point in zip(runs, points or (runs[0].origin, runs[1].origin), strict=True)
        for k, programme in enumerate(one.programmes)
    ][: len(runs[0].programmes) if same else None]
    labels = {one.label for one in proved}
    twins = forward.one_way_twins(sorted(labels), moments)
    found = []
    for one in proved:
        like = [name for name in twins.get(one.label, ()) if name not in labels]
        acts = tuple(dict.fromkeys([*one.acts_like, *like]))
        found.append(replace(one, acts_like=acts, firm=one.firm and not like))
    return tuple(found)
