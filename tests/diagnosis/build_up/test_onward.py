"""A valve with a dead band: what else acts on its command shows beside the best pair alone."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ves_twin.core.budget import Budget
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.build_up import best_proved as best_proved_module
from ves_twin.diagnosis.build_up import in_full as in_full_module
from ves_twin.diagnosis.build_up import judges as judges_module
from ves_twin.diagnosis.build_up import trials as trials_module
from ves_twin.diagnosis.build_up.best_proved import best_proved, promising
from ves_twin.diagnosis.build_up.builder import Builder, Start
from ves_twin.diagnosis.build_up.in_full import _likeliest, in_full
from ves_twin.diagnosis.build_up.offer import least_left
from ves_twin.diagnosis.build_up.plain_selector import PlainSelector
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.select import Selector
from ves_twin.diagnosis.build_up.trials import Library, Trial, columns_of, trials_at
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.evidence import Evidence
from ves_twin.diagnosis.record.preprocess import Dataset
from ves_twin.diagnosis.record.runs import Runs, silent
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.machine import Rig

MODEL = """<mujoco><option timestep="0.05" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody><body name="rod"><joint name="boom" type="slide" damping="100"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
  <actuator><motor name="valve" joint="boom"/></actuator></mujoco>"""

DESCRIPTION = """schema = 1
kind = "rig"
name = "boom"
model = "boom.xml"
rate = 20
[clock]
column = "t"
[signals.duty]
columns = ["u"]
unit = "N"
[signals.length]
columns = ["x"]
unit = "m"
noise = "0.2 mm"
[drive]
mode = "control"
actuators = { valve = "duty" }
[compare.length]
joint = "boom"
[typical.joint.boom]
effort = 2
speed = "2 cm/s"
travel = "5 cm"
""" + "".join(
    f'[[effects]]\nkind = "actuator_{kind}"\non = ["valve"]\nlargest = {largest}\n'
    for kind, largest in (("gain", 3), ("deadband", 1.8), ("delay", 0.3), ("asymmetry", 0.8))
)

HIDDEN = {
    "actuator_gain@valve:gain": 1.0,
    "actuator_deadband@valve:band": 0.9,
    "actuator_delay@valve:delay": 0.1,
}


@pytest.fixture(scope="module")
def forward(tmp_path_factory):
    folder = tmp_path_factory.mktemp("boom")
    (folder / "boom.xml").write_text(MODEL)
    (folder / "boom.toml").write_text(DESCRIPTION)
    return MjcfForward.of(Rig.load(str(folder / "boom.toml")))


def seen(forward: MjcfForward, seed: int) -> Dataset:
    rng = np.random.default_rng(seed)
    time = 0.05 * np.arange(600)
    tones = np.sin(2.0 * np.pi * np.outer(time, [0.11, 0.29, 0.53]) + rng.uniform(0.0, 6.28, 3))
    fed = Excitation("manual", time, {"duty": 1.2 * tones.sum(axis=1, keepdims=True)}, rate=20.0)
    runs = Runs(forward, (fed,), (0,))
    names = [axis.parameter.name for axis in runs.coordinates]
    rows = runs.one(np.array([HIDDEN.get(name, 0.0) for name in names]))
    return Dataset(runs, rows + 2e-4 * rng.standard_normal(rows.shape).astype(np.float32), ())


def builder_of(forward: MjcfForward) -> Builder:
    """One that offers the whole library, on two drawn recordings."""
    screen = SimpleNamespace(bank=SimpleNamespace(hypotheses=forward.hypotheses))
    desk = SimpleNamespace(first=SimpleNamespace(screen=screen), progress=silent)
    return Builder(desk, seen(forward, 1), seen(forward, 2))


def causes(offer) -> set[str]:
    """Effects that are proved."""
    return {offer.halves.regression.trials[n].cause.effect for n in offer.proof.proved}


def spread(offers) -> float:
    """Largest over smallest p of the same cause, the worst of all causes; all are proved by all."""
    every = [[test.p for test in offer.proof.differences.values()] for offer in offers]
    assert {len(some) for some in every} == {len(offers[0].proof.proved)}
    return float(np.max(np.max(every, axis=0) / np.min(every, axis=0)))


def test_what_a_dead_band_hides_is_found_beside_it(forward):
    builder = builder_of(forward)
    found = builder.best()
    assert causes(found) == {"actuator_gain", "actuator_deadband", "actuator_delay"}
    runs = builder.fitted.runs
    told = {axis.parameter.name: found.fit.shift[i] for i, axis in enumerate(runs.coordinates)}
    for name, size in HIDDEN.items():
        assert told[name] == pytest.approx(size, rel=0.1)


def test_a_dead_band_and_what_acts_beyond_it_are_chosen_by_plain_squares(forward):
    builder = builder_of(forward)
    regression = builder.halves(builder.fitted.runs.origin, ()).regression
    names = {regression.trials[n].cause.effect for n in PlainSelector(regression).run()}
    assert {"actuator_gain", "actuator_deadband"} <= names


def test_a_fit_looks_from_the_sizes_of_bent_columns_too(forward, monkeypatch):
    builder = builder_of(forward)
    origin = builder.fitted.runs.origin
    wanted = {
        "actuator_gain@valve": (2.0,),
        "actuator_deadband@valve": (0.8,),
        "actuator_delay@valve": (0.1,),
    }
    library = {h.label: h for h in forward.hypotheses}
    present = tuple(
        Trial(library[label], sizes, positive=True, bent=True) for label, sizes in wanted.items()
    )
    halves = builder.halves(origin, present)
    chosen = [n for n, trial in enumerate(halves.regression.trials) if trial in present]
    evidence = builder.evidence(halves.regression.fit(chosen).residual)
    monkeypatch.setattr(in_full_module, "_likeliest", lambda *_: builder.fitted.runs.high)
    fit = in_full(halves.regression, chosen, origin, evidence)
    names = [halves.regression.trials[n].cause.parameters[0] for n in chosen]
    assert fit.sizes == pytest.approx([HIDDEN[name] for name in names], rel=0.1)


def test_a_fit_begins_where_least_is_left(forward):
    data = seen(forward, 1)
    runs = data.runs
    evidence = Evidence(runs, data.measured, whitening_declared(runs))
    true = np.array([HIDDEN.get(axis.parameter.name, 0.0) for axis in runs.coordinates])
    starts = (2.0 * true, true, runs.origin)
    assert _likeliest(evidence, starts) is true


def choosing(kinds):
    """A selection that chooses effects by how many are at work."""

    def run(selector, begin=()):
        labels = [trial.cause.label for trial in selector.regression.trials]
        return [labels.index(f"actuator_{kind}@valve") for kind in kinds(selector, len(begin))]

    return run


def choose(monkeypatch, ahead, plainly):
    """Let both ways choose so."""
    run = choosing(plainly)
    monkeypatch.setattr(Selector, "run", choosing(ahead))
    monkeypatch.setattr(PlainSelector, "path", lambda *given: [run(*given)])


def test_a_round_that_leaves_more_than_the_one_before_is_not_kept(forward, monkeypatch):
    begun: list[int] = []

    def kinds(_, count):
        begun.append(count)
        return ("asymmetry",) if count else ("gain", "deadband")

    monkeypatch.setattr(Selector, "run", choosing(kinds))
    builder = builder_of(forward)
    origin = builder.fitted.runs.origin
    first = builder.halves(origin, ())
    chosen = Selector(first.regression).run()
    halves, _, kept = builder.settled(Selector, first, chosen, origin)
    names = {halves.regression.trials[n].cause.effect for n in kept}
    assert names == {"actuator_gain", "actuator_deadband"}
    assert begun == [0, 2]


@pytest.mark.parametrize("first", [True, False])
def test_of_two_choices_the_one_that_predicts_held_out_rows_better_is_kept(
    forward, monkeypatch, first
):
    both = (lambda *_: ("gain", "deadband"), lambda *_: ("asymmetry",))
    ahead, plainly = both if first else both[::-1]
    choose(monkeypatch, ahead, plainly)
    builder = builder_of(forward)
    found = builder.best()
    assert causes(found) == {"actuator_gain", "actuator_deadband"}
    assert len(found.known) == 3


@pytest.mark.parametrize("first", [True, False])
def test_where_there_is_time_for_one_choice_the_more_promising_one_is_fitted(
    forward, monkeypatch, first
):
    both = (lambda *_: ("gain", "deadband"), lambda *_: ("asymmetry",))
    choose(monkeypatch, *(both if first else both[::-1]))
    builder = builder_of(forward)
    spent = iter([0.0])
    workers = Workers(1, Budget(1.0, lambda: next(spent, 3600.0)))
    fitted = replace(builder.fitted, runs=replace(builder.fitted.runs, workers=workers))
    late = replace(builder, fitted=fitted)
    origin = fitted.runs.origin
    (found,) = late.offers(late.halves(origin, ()), origin)
    assert causes(found) == {"actuator_gain", "actuator_deadband"}
    left_out = {True: "plain squares", False: "one-step prediction errors"}[first]
    assert f"causes chosen by {left_out}" in workers.budget.left_out


def test_a_rejected_cause_makes_room_for_the_one_that_it_stood_for(forward, monkeypatch):
    """The asymmetry that is chosen first is none; barred, what is true comes in its place.

    By one-step errors: in plain ones it takes away half of what the delay does.
    """
    monkeypatch.setattr(judges_module, "ERRORS", ((True, False),))

    def kinds(selector, _):
        barred = "actuator_asymmetry@valve" in selector.regression.barred
        return ("gain", "deadband", "delay") if barred else ("gain", "deadband", "asymmetry")

    choose(monkeypatch, kinds, kinds)
    builder = builder_of(forward)
    origin = builder.fitted.runs.origin
    (begun,) = builder.offers(builder.halves(origin, ()), origin)
    assert begun.rejected == {"actuator_asymmetry@valve"}
    found = builder.best()
    assert causes(found) == {"actuator_gain", "actuator_deadband", "actuator_delay"}
    assert found.proof.tested == 4


def test_an_offer_that_the_count_of_all_leaves_nothing_gives_way_to_the_next(forward, monkeypatch):
    """A link of twice its mass beside a delay: by the count of all only the delay stayed."""
    choose(monkeypatch, *2 * (lambda *_: ("gain", "deadband"),))
    builder = builder_of(forward)
    found = builder.best()
    counted = builder._counted(found, found.known | {"one more"})
    assert counted.proof.tested == found.proof.tested + 1
    fewer = replace(found.proof, proved=found.proof.proved[:1])
    other = replace(found, proof=fewer, known=counted.known, held_out=1.05 * found.held_out)

    def less(self, offer, known):
        if offer is other:
            return offer
        nothing = replace(offer.proof, proved=())
        return replace(offer, proof=nothing, held_out=offer.halves.held.target, known=known)

    monkeypatch.setattr(Builder, "_counted", less)
    monkeypatch.setattr(Builder, "few", lambda *_: [other])
    monkeypatch.setattr(Builder, "about_its_fit", lambda _, offer: offer)
    assert builder.best() is other


def test_offers_of_the_same_causes_from_different_points_end_in_the_same_proof(forward):
    """Rounding decided which of two was preferred, and with it what was firm (an excavator)."""
    builder = builder_of(forward)
    origin = builder.fitted.runs.origin
    halves = builder.halves(origin, ())
    trials = halves.regression.trials
    (gain,) = (n for n, t in enumerate(trials) if t.cause.effect == "actuator_gain")
    bands = [n for n, t in enumerate(trials) if t.cause.effect == "actuator_deadband"]
    offers = [builder.offer(halves, origin, [gain, band], frozenset()) for band in bands]
    assert spread(offers) > 100.0
    assert spread([builder.about_its_fit(offer) for offer in offers]) < 1.05


def test_many_causes_never_end_worse_than_the_best_pair(forward, monkeypatch):
    """Both ways are made to choose what is not there; the best of Selector.best stays in play."""
    choose(monkeypatch, *2 * (lambda *_: ("asymmetry",),))
    builder = builder_of(forward)
    origin = builder.fitted.runs.origin
    halves = builder.halves(origin, ())
    (pair,) = builder.few(halves, origin, frozenset())
    (alone,) = builder.offers(halves, origin)
    assert len(causes(pair)) == 2
    found = builder.best()
    left, by_pair = (halves.held.rms(offer.held_out) for offer in (found, pair))
    assert np.all(left <= by_pair * (1.0 + 1e-6))
    assert np.all(by_pair < 0.9 * halves.held.rms(alone.held_out))
    assert found.known == pair.known | alone.known


def test_what_a_simulation_that_broke_off_leaves_is_never_least(forward):
    held = builder_of(forward).halves(builder_of(forward).fitted.runs.origin, ()).held
    good, broken = 0.1 * held.target, held.target * np.nan
    left = [held.target, broken, good]
    assert least_left(held, np.array([1e-9]), left) == 2
    assert least_left(held, np.array([1e-9]), [broken, good]) == 1


def test_what_a_longer_choice_loses_is_taken_from_the_way(forward, monkeypatch):
    """A proof that fails wherever the asymmetry is in, as where causes mimic each other."""
    builder = builder_of(forward)
    halves = builder.halves(builder.fitted.runs.origin, ())
    labels = [trial.cause.label for trial in halves.regression.trials]
    path = PlainSelector(halves.regression).path()
    short, odd = path[-1], labels.index("actuator_asymmetry@valve")

    def failing(regression, held, chosen, more=0):
        found = prove(regression, held, chosen, more)
        return replace(found, proved=()) if odd in chosen else found

    monkeypatch.setattr(best_proved_module, "weighed", failing)
    sets = [[], short[:1], short, [*short, odd]]
    found, known = best_proved(halves, sets, frozenset({"another"}))
    assert found == list(prove(halves.regression, halves.held, short).proved)
    assert known == {"another", *(labels[n] for n in short)}
    assert best_proved(halves, [[odd]], frozenset()) == ([], frozenset())


def test_a_cause_that_bends_at_first_is_not_probed_again(forward):
    """Its bank sizes are all there; what was linear is probed, and may be linear there, too."""
    builder = builder_of(forward)
    runs = builder.fitted.runs
    first = builder.halves(runs.origin, ()).regression.trials
    told = replace(builder, told=Library.after(forward.hypotheses, first, fewer=False))
    bent = {trial.cause.effect for trial in first if trial.bent}
    assert "actuator_deadband" in bent
    assert "actuator_gain" not in bent
    band = next(trial for trial in first if trial.cause.effect == "actuator_deadband")
    point = runs.depart(runs.origin, runs.indices(band.cause), np.array(band.sizes))
    found = told.halves(point, (band,)).regression.trials
    plain = builder.halves(point, (band,)).regression.trials
    every = {trial for trial in plain if trial.cause.effect in bent}
    assert every <= set(found)
    assert len(found) == len(set(found))
    assert not any(trial.bent for trial in found if trial.cause.effect == "actuator_gain")


def test_a_cause_that_was_linear_costs_one_run_where_no_bent_one_is_at_work(forward, monkeypatch):
    runs = builder_of(forward).fitted.runs
    asked: list[int] = []

    def counted(runs, point, trials, *more):
        asked.append(len(trials))
        return columns_of(runs, point, trials, *more)

    monkeypatch.setattr(trials_module, "columns_of", counted)
    first, _ = trials_at(runs, runs.origin, forward.hypotheses)
    told = Library.after(forward.hypotheses, first, fewer=False)
    gain = next(trial for trial in first if trial.cause.label in told.straight)
    point = runs.depart(runs.origin, runs.indices(gain.cause), np.array(gain.sizes))
    again, _ = trials_at(runs, point, told)
    assert {t for t in again if not t.bent} == {t for t in first if not t.bent}
    assert asked[0] == 3 * len(forward.hypotheses)
    assert asked[2] == len(told.straight)
    band = next(trial for trial in first if trial.cause.label in told.bent)
    trials_at(runs, point, told, (band,))
    assert asked[4] == 3 * len(told.straight)


def test_where_runs_are_dear_a_bent_cause_has_fewer_sizes(forward):
    runs = builder_of(forward).fitted.runs
    every, _ = trials_at(runs, runs.origin, Library(forward.hypotheses))
    fewer, _ = trials_at(runs, runs.origin, Library(forward.hypotheses, fewer=True))
    assert {t for t in fewer if t.bent} < {t for t in every if t.bent}
    assert {t.cause for t in fewer} == {t.cause for t in every}


def test_what_is_at_work_and_adds_nothing_is_offered_once(forward, monkeypatch):
    """From a start that both ways keep an offer comes; beside an earlier one it is none."""
    builder = builder_of(forward)
    cause = {one.label: one for one in forward.hypotheses}["actuator_gain@valve"]
    trial = Trial(cause, (1.0,), positive=True, bent=True)
    choose(monkeypatch, *2 * (lambda *_: ("gain",),))
    point = builder.fitted.runs.origin.copy()
    point[builder.fitted.runs.indices(cause)] = 1.0
    halves = builder.halves(point, (trial,))
    assert builder.offers(halves, point, (trial,))
    found = builder.offers(halves, point, (trial,), frozenset({cause.label}))
    assert len(found) < 2
    assert cause.label in builder.best(Start(point, (trial,))).proved


@pytest.mark.parametrize(("behind", "ways"), [(1e9, {0, 1}), (-1.0, set())])
def test_a_choice_that_is_far_behind_is_not_fitted_in_full(forward, monkeypatch, behind, ways):
    builder = builder_of(forward)
    halves = builder.halves(builder.fitted.runs.origin, ())
    kinds = [trial.cause.effect for trial in halves.regression.trials]
    good = [kinds.index("actuator_gain"), kinds.index("actuator_deadband")]
    poor = [kinds.index("actuator_asymmetry")]
    known = frozenset[str]()
    assert promising(halves, [poor, good], known)[0] == 1
    assert promising(halves, [good, good[::-1]], known) in ([0], [1])
    assert promising(halves, [[]], known) == [0]
    monkeypatch.setattr(best_proved_module, "BEHIND", behind)
    assert set(promising(halves, [poor, good], known)) == ways
