"""A name is not firm where a law of the same motion is left, though nobody looks for laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pendulum import MACHINE
from scipy.signal import lfilter
from sizes import nightly_but

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.settings import Settings
from ves_twin.effects.law import LawKind
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.inputs.programmes import multisine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Allowed
from ves_twin.machines.mjcf.rig.machine import Rig

KINDS = ("cubic_spring", "viscous_friction", "coulomb_friction")
LIBRARY = tuple(Allowed(kind=kind, on=("joint",)) for kind in KINDS)
RIG = replace(
    MACHINE,
    description=MACHINE.description.model_copy(update={"causes": 6, "effects": LIBRARY}),
)
STOPS = LawTable(
    place="joint",
    kind=LawKind.EFFORT,
    of=("position@joint",),
    knots=((-3.0, -0.35, 0.35, 3.0),),
    values=(8.0, 0.0, 0.0, -8.0),
)
"""Soft ones at 0.35 rad to either side, of 3 N m/rad; the joint swings to half a radian."""
SLUGGISH = 0.95
"""Of model error, 2 % of the motion, which is kept from row to row."""


def recorded(rig: Rig, hidden: dict[str, float], seed: int) -> Recording:
    """A swing in the world of a rig, with coloured model error and noise."""
    drawn = multisine(MACHINE, np.random.default_rng(seed), 6.0)
    fed = Excitation("", drawn.time, {name: 0.5 * rows for name, rows in drawn.drive.items()})
    rows = MjcfForward.of(rig).simulate(fed, hidden)
    rng = np.random.default_rng(seed + 10)
    colour = lfilter([1.0], [1.0, -SLUGGISH], rng.standard_normal(rows.shape), axis=0)
    rows = rows + 0.02 * np.sqrt(1.0 - SLUGGISH**2) * np.std(rows, axis=0) * colour
    rows = rows + [0.001, 0.01] * rng.standard_normal(rows.shape)
    signals = {"joint.angle": rows[:, :1], "joint.rate": rows[:, 1:], **fed.drive}
    return Recording(fed.time, signals, RecordingInfo("measured", scenario=f"swing {seed}"))


@pytest.mark.parametrize(
    ("laws", "stiffness", "firm"), nightly_but(0, [((STOPS,), 0.0, False), ((), 2.0, True)])
)
def test_a_cubic_spring_is_firm_where_it_is_one_and_not_where_stops_are(laws, stiffness, firm):
    world = replace(RIG, description=RIG.description.model_copy(update={"laws": laws}))
    hidden = {"viscous_friction@joint:damping": 0.12, "cubic_spring@joint:stiffness": stiffness}
    one, two = (recorded(world, hidden, seed) for seed in (1, 2))
    settings = Settings(nulls=4, laws=False, cache=None)
    found = diagnose([one], RIG, held_out=[two], settings=settings).verdict
    told = {name.label: name.firm for name in found.proved}
    assert told["cubic_spring@joint"] is firm
