"""An arm with a drag at its second joint in a record far louder than its noise, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from arm import arm, motion

from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import refine
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.loud import loud_screen
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig

DRAG = 0.6
"""N m s^2/rad^2: at chi^2 of 10^6 a sample."""

ROTOR = 0.005
"""kg m^2 that the first rotor has more of, half its sd."""

FOLDER = TemporaryDirectory()


@cache
def forward(noise: float = 1e-3) -> MjcfForward:
    """The arm without a drag, torques fed in, whose angles are told with a noise [rad]."""
    arm(Path(FOLDER.name), {})
    path = Path(FOLDER.name) / f"arm_{noise}.toml"
    text = path.with_name("arm.toml").read_text()
    path.write_text(text.replace("noise = 1e-3", f"noise = {noise}"))
    return MjcfForward.of(Rig.load(str(path)), Mode.CONTROL)


def drag(speed: np.ndarray) -> np.ndarray:
    """N m at the second joint."""
    return -DRAG * np.abs(speed) * speed


@cache
def seen(seed: int, share: float = 1.0, noise: float = 1e-3) -> Dataset:
    """8 s of an arm with a share of the drag."""
    time, torques = motion(8.0, seed)
    fed = Excitation("", time, {"ta": 4.0 * torques[:, :1], "tb": 4.0 * torques[:, 1:]})
    x = np.linspace(-6.0, 6.0, 6001)
    knots, values = (tuple(x.tolist()),), tuple((share * drag(x)).tolist())
    law = Law("b", LawKind.EFFORT, LawShape.TABLE, ("speed@b",), knots, values)
    rows = forward().simulate(fed, {"rotor_inertia@a:inertia": ROTOR}, False, (law,))
    rows = rows + noise * np.random.default_rng(1).standard_normal(rows.shape)
    signals = {**fed.drive, "qa": rows[:, :1], "qb": rows[:, 1:]}
    recording = Recording(time, signals, RecordingInfo("measured", scenario="dragged"))
    return preprocess(forward(noise), [recording])


@cache
def looked() -> tuple[Evidence, LawFit]:
    """The dragged arm, and commissioning errors fitted alone."""
    record = seen(5)
    evidence = Evidence(record.runs, record.measured, whitening_declared(record.runs))
    base = linearise(record.runs, record.runs.origin, forward_step=1.0)
    alone = refine(evidence, (), record.runs.origin, base, 2)
    return evidence, fit_law(evidence, None, alone)


@cache
def fitted() -> LawFit:
    """A table of the drag, fitted from where inverse dynamics puts it."""
    evidence, none = looked()
    first = loud_screen(evidence, none, forward().law_places())[0]
    unstrained = replace(none.fit, shift=np.zeros_like(none.fit.shift))
    return fit_law(evidence, first.candidate, unstrained, first.numbers)
