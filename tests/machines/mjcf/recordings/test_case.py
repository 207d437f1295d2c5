"""What a comparison says beside its figures: laws that are held, bands, ranges, lengths."""

from dataclasses import replace

import numpy as np
import pytest
from pendulum import FED, MACHINE

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.effects.law import LawKind
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.machine import Named
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.recordings.case import _unsized
from ves_twin.machines.mjcf.rig.description import Typical


def notes(reach: float) -> str:
    law = LawTable(
        place="joint",
        kind=LawKind.EFFORT,
        of=("speed@joint",),
        knots=((-reach, reach),),
        values=(0.1, -0.1),
    )
    rig = replace(MACHINE, description=MACHINE.description.model_copy(update={"laws": (law,)}))
    rows = MjcfForward.of(rig).simulate(FED, {})
    signals = {"joint.angle": rows[:, :1], "joint.rate": rows[:, 1:], **FED.drive}
    recording = Recording(FED.time, signals, RecordingInfo("measured", scenario="run"))
    (case,) = MjcfMachine(rig).cases(Named("run", recording))
    assert np.all(np.isfinite(case.simulated()["joint.rate"]))
    return " ".join(case.notes)


def test_a_motion_beyond_the_range_of_a_law_is_told_with_its_share():
    assert "joint(speed@joint) is held in" in notes(1.0)


def test_a_motion_within_the_range_of_a_law_is_not_mentioned():
    assert "held" not in notes(50.0)


@pytest.mark.parametrize(("rate", "told"), [(20.0, True), (100.0, False)])
def test_a_comparison_of_more_than_a_diagnosis_looks_at_says_so(rate, told):
    """An isolator's force fell by 6 % over all rows, and by 38 % below 50 Hz, which is fitted."""
    rig = replace(MACHINE, description=MACHINE.description.model_copy(update={"rate": rate}))
    rows = MjcfForward.of(rig).simulate(FED, {})
    signals = {"joint.angle": rows[:, :1], "joint.rate": rows[:, 1:], **FED.drive}
    recording = Recording(FED.time, signals, RecordingInfo("measured", scenario="run"))
    (case,) = MjcfMachine(rig).cases(Named("run", recording))
    assert ("a diagnosis looks below 10 Hz alone" in " ".join(case.notes)) is told


@pytest.mark.parametrize("told", [Typical(), MACHINE.description.typical])
def test_a_signal_that_lacks_its_range_is_named_with_the_key_that_tells_it(told):
    """A gyro's gain of 5 % was not among the causes of a satellite, and nothing said so."""
    description = MACHINE.description.model_copy(update={"typical": told})
    note = " ".join(_unsized(replace(MACHINE, description=description), ["joint.angle"]))
    assert ("without [typical.signal] joint.angle.span" in note) is (told == Typical())


@pytest.mark.parametrize("rows", [3, 400, 1000])
def test_a_recording_of_which_hardly_a_row_is_compared_is_refused_in_one_line(rows):
    """A clock of milliseconds taken for seconds made 20 s into 0.02 s, and a traceback."""
    signals = {"joint.angle": np.zeros((rows, 1)), "joint.rate": np.zeros((rows, 1))}
    signals["joint.torque"] = np.ones((rows, 1))
    short = Recording(2e-4 * np.arange(rows), signals, RecordingInfo("measured", scenario="a"))
    with pytest.raises(InvalidInputError, match="is its clock in that unit"):
        MjcfMachine(MACHINE).cases(Named("a.csv", short))
