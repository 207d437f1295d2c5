"""Laws on VES II: in its forward, in comparisons, as causes, and found where nobody has told them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.diagnosis.bank.linearise import linearise
from ves_twin.diagnosis.fit.refine import bare_residual, refine
from ves_twin.diagnosis.law.candidate import Candidate
from ves_twin.diagnosis.law.fit_law import LawFit, fit_law
from ves_twin.diagnosis.law.lean import LeanEvidence
from ves_twin.diagnosis.law.propose import Limits, Search, search_laws
from ves_twin.diagnosis.model.forward import Excitation, Hypothesis, Parameter
from ves_twin.diagnosis.model.forward_wrapper import ForwardWrapper
from ves_twin.diagnosis.model.law_forward import LawForward, LawPlace
from ves_twin.diagnosis.record.preprocess import Dataset, preprocess
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.machine import Named
from ves_twin.machines.ves2.filter_place import WithFilterPlaces
from ves_twin.machines.ves2.forward import RigForward
from ves_twin.machines.ves2.ves2_machine import Ves2Machine
from ves_twin.suites.hidden_law import Acts, HiddenLaw
from ves_twin.suites.machine import BlindRig
from ves_twin.suites.ves2 import BlindVes2

FAST = vt.Plant.load("ves2_fast")
SCENARIO = vt.Scenario.load("identify_fast", {"plant": "ves2_fast", "run.duration": 4.0})

DIFFERENCES = 0.01
"""Share of a law of speed that differences of rows 12.6 ms apart may make of the rod's own speed."""

COUNT = 0.05
"""A few counts of the force sensor [N]; its noise-free replay has none."""


def law(place: str, of: str, low: float, high: float, reach: float = 2.0, **more) -> LawTable:
    told = {"kind": LawKind.EFFORT, "knots": ((-reach, reach),), **more}
    return LawTable(place=place, of=(of,), values=(low, high), **told)


@cache
def fed() -> tuple[RigForward, Excitation]:
    forward = RigForward(FAST, SCENARIO)
    run = vt.simulate(SCENARIO, FAST)
    return forward, Excitation.of(run, forward.drive)


def test_ves2_is_a_plant_with_places_for_laws():
    forward, _ = fed()
    assert isinstance(forward, LawForward)
    assert isinstance(WithFilterPlaces(forward), LawForward)
    places = {place.name: place for place in forward.law_places()}
    assert {"leg.3", "arm.q2", "platform.rz", "sensor.wrench.3", "arm.torque.1"} <= places.keys()
    assert [v.name for v in places["arm.q2"].variables] == [
        "position@arm.q2", "speed@arm.q2", "time", "command@arm.q2",
    ]  # fmt: skip
    _, programme = fed()
    visited = forward.visited(programme, {})
    assert {v.name for place in places.values() for v in place.variables} <= visited.keys()


@pytest.mark.parametrize(
    "told",
    [
        law("arm.q2", "speed@arm.q2", 30.0, -30.0),
        law("sensor.wrench.3", "speed@arm.q2", -20.0, 20.0, kind=LawKind.READING),
    ],
)
def test_a_law_that_is_tried_is_the_law_of_a_file(told: LawTable):
    forward, programme = fed()
    tried = forward.simulate(programme, {}, False, [told.law])
    inside = replace(forward, plant=FAST.with_laws(told)).simulate(programme, {})
    assert np.array_equal(tried, inside)
    plain = forward.simulate(programme, {})
    assert not np.allclose(tried, plain)
    quiet = SCENARIO.run.model_copy(update={"noise": False})
    silent = SCENARIO.model_copy(update={"run": quiet})
    signal = told.place.rpartition(".")[0] if told.kind is LawKind.READING else "arm.torque"
    at = [n for n, c in enumerate(forward.channels) if c.signal == signal]
    run = [vt.simulate(silent, plant)[signal] for plant in (FAST, FAST.with_laws(told))]
    rows = slice(100, -10)  # what begins at rest, and the commands that a spline still waits for
    change = (tried - plain)[rows, at[0] : at[-1] + 1]
    off = np.abs(change - (run[1] - run[0])[rows]).max()
    assert off < DIFFERENCES * np.abs(change).max() + COUNT


def test_a_law_that_is_a_cause_may_be_named_and_is_at_work_then():
    forward, programme = fed()
    cause = law("arm.q2", "speed@arm.q2", 30.0, -30.0, cause=True)
    lawful = replace(forward, plant=FAST.with_laws(cause))
    assert cause.name in {p.name for p in lawful.parameters}
    assert cause.law.label in {h.target for h in lawful.hypotheses}
    half = lawful.simulate(programme, {cause.name: 0.5})
    tried = forward.simulate(programme, {}, False, [cause.scaled(0.5).law])
    assert np.array_equal(half, tried)
    assert np.array_equal(lawful.simulate(programme, {}), forward.simulate(programme, {}))


@pytest.mark.parametrize(("reach", "said"), [(0.2, True), (9.0, False)])
def test_a_comparison_says_where_a_law_is_held(reach: float, said: bool):
    machine = Ves2Machine(FAST.with_laws(law("arm.q2", "speed@arm.q2", 1.0, -1.0, reach)))
    (case,) = machine.cases(Named("run", vt.simulate(SCENARIO, FAST)))
    assert any("arm.q2(speed@arm.q2) is held in" in note for note in case.notes) is said


@dataclass(frozen=True)
class Arm(ForwardWrapper):
    """VES II with tolerances and places of two joints of its arm alone, for fewer runs."""

    forward: RigForward

    @property
    def identity(self) -> str:
        return self.identified("arm")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        own = ("@arm.q1", "@arm.q2", "@sensor.")
        return tuple(p for p in self.forward.parameters if any(part in p.name for part in own))

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        return ()

    def law_places(self) -> tuple[LawPlace, ...]:
        own = ("arm.q1", "arm.q2", "arm.torque.1", "arm.torque.2")
        return tuple(place for place in self.forward.law_places() if place.name in own)

    def simulate(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        refined: bool = False,
        laws: Sequence[Law] = (),
    ) -> FloatArray:
        return self.forward.simulate(programme, values, refined, laws)

    def visited(
        self, programme: Excitation, values: Mapping[str, float], laws: Sequence[Law] = ()
    ) -> Mapping[str, FloatArray]:
        return self.forward.visited(programme, values, laws)

    def missing(
        self,
        programme: Excitation,
        values: Mapping[str, float],
        measured: Mapping[str, FloatArray],
    ) -> None:
        """None."""


@dataclass(frozen=True)
class Truth(Candidate):
    """The hidden function with a factor."""

    hidden: HiddenLaw

    @property
    def start(self) -> FloatArray:
        return np.ones(1)

    @property
    def sd(self) -> FloatArray:
        return np.ones(1)

    def law(self, numbers: FloatArray) -> Law:
        x = np.linspace(-4.0, 4.0, 4001)
        values = tuple((numbers[0] * self.hidden.function(x)).tolist())
        names = (self.hidden.of,)
        return Law(self.place.name, self.place.kind, LawShape.TABLE, names, (tuple(x),), values)


def odd(speed: FloatArray) -> FloatArray:
    """N m: a drag that is in no dictionary, stronger one way than the other."""
    return -3.0 * np.sinh(1.5 * speed) - 2.0 * np.cosh(speed) * np.square(speed)


HIDDEN = HiddenLaw("odd", Acts.SPEED, "arm.q2", "speed@arm.q2", odd)

LIMITS = Limits(misfit=6.5, pull=3.8, model_error=0.02)
"""As null rigs of VES II have them with the settings of `diagnose`."""


SHOWN = 0.03
"""Mean z^2 of the held-out record, 19 columns together, that the truth itself takes away."""

ROWS = 480
"""Of a record: the first 6 s, in which the arm goes there and half the way back."""


def measured(law: HiddenLaw | None, programme: str) -> Recording:
    """A rig within its tolerances, half the step, another integrator, shaken and noisy."""
    machine, rng = BlindVes2("ves2_fast"), np.random.default_rng(5)
    drawn = machine.commissioned(rng)
    values = {p.name: drawn[p.name] for p in Arm(machine.forward).parameters if p.name in drawn}
    rows = machine.record(BlindRig(values, law=law), programme, rng)
    signals = {name: column[:ROWS] for name, column in rows.signals.items()}
    return replace(rows, time=rows.time[:ROWS], signals=signals)


def searched(law: HiddenLaw | None) -> Search:
    seen = preprocess(Arm(BlindVes2("ves2_fast").forward), [measured(law, "train")])
    declared = whitening_declared(seen.runs)
    evidence = LeanEvidence(seen.runs, seen.measured, declared)
    base = linearise(seen.runs, seen.runs.origin, forward_step=1.0)
    alone = refine(evidence, (), seen.runs.origin, base)
    own = declared.adapted(declared.apply(bare_residual(evidence, alone)))
    evidence = LeanEvidence(seen.runs, seen.measured, own)
    alone = refine(evidence, (), alone.shift, base)
    found = search_laws(evidence, alone, LIMITS)
    assert found is not None
    return found


def squares(fit: LawFit, held: Dataset) -> float:
    """Mean z^2 of a held-out record by a fit, nothing tuned there."""
    runs = replace(held.runs, forward=fit.fit.local.runs.forward)
    z = whitening_declared(runs).apply(held.measured - runs.one(fit.fit.shift))
    return float(np.mean(np.square(z)))


@pytest.mark.nightly
@pytest.mark.timeout(1800)
def test_a_hidden_drag_of_a_joint_is_found_with_place_variable_and_gain():
    search = searched(HIDDEN)
    best = search.best
    assert best.candidate is not None
    found = best.candidate.law(best.numbers)
    assert (found.place, found.of) == (HIDDEN.place, (HIDDEN.of,))
    assert search.reason == ""
    place, of = best.candidate.place, best.candidate.of
    truth = fit_law(search.evidence, Truth(place, of, HIDDEN), best.fit)
    held = preprocess(Arm(BlindVes2("ves2_fast").forward), [measured(HIDDEN, "held_out")])
    without, with_law, true = (squares(fit, held) for fit in (search.none, best, truth))
    assert without - true > SHOWN
    assert without - with_law > 0.95 * (without - true)


@pytest.mark.nightly
def test_a_rig_in_order_has_no_law():
    assert searched(None).reason


def test_the_file_of_a_claimed_law_is_the_rig_with_it(tmp_path: Path):
    told = law("arm.q2", "speed@arm.q2", 30.0, -30.0)
    Ves2Machine(FAST.with_laws(told)).save(tmp_path / "plant.toml")
    assert vt.Plant.load(str(tmp_path / "plant.toml")).laws == (told.law,)
