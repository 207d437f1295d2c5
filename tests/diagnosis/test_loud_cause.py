"""A cause so loud that the integrator's error in it passes for commissioning errors."""

from __future__ import annotations

import numpy as np

from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.machines.diagnose import diagnose
from ves_twin.suites.law_suite import LIBRARY, MACHINE, LawTruth, hidden_in, machine_of
from ves_twin.suites.machine import BlindRig

SEED = (990130, 203)
"""A joint spring of 3800 sigma, as `make laws` drew it: beside it 4.1 sd of a tolerance are fitted,
where a rig in order has 3.5 at most."""


def test_a_loud_cause_is_named_though_its_simulation_strains_a_tolerance():
    machine = machine_of(MACHINE)
    rng = np.random.default_rng([SEED[0], 0])
    standing = machine.record(BlindRig(machine.commissioned(rng)), "standstill", rng)
    rig, _ = hidden_in(machine, LawTruth("loud", LIBRARY, SEED))
    rng = np.random.default_rng([*SEED, 1])
    again = BlindRig(machine.again(rig.values, rng, 1.0, 0.0))
    recording = machine.record(rig, "train", rng)
    held_out = machine.record(again, "held_out", rng)
    settings = Settings(nulls=30)
    found = diagnose(
        [recording], MACHINE, held_out=[held_out], standstill=standing, settings=settings
    )
    verdict = found.verdict
    assert verdict.verdict is Kind.NAMED
    (cause,) = verdict.causes
    assert (cause.effect, cause.firm) == ("joint_spring", True)
    (size,) = cause.parameters.values()
    assert size.low < rig.values["joint_spring@joint:stiffness"] < size.high
