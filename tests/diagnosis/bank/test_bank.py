"""The bank, its cache, and the screen's closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toy import CAUSES, GAIN, Toy, _cause, programme, record

from ves_twin.core.budget import Budget
from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.workers import Workers
from ves_twin.diagnosis.bank.screen import Screen
from ves_twin.diagnosis.bank.signature_library import build_bank, cached_bank
from ves_twin.diagnosis.experiment.findable import MARGIN, findable_sizes
from ves_twin.diagnosis.fit.null import LEAST, cached_thresholds, null_thresholds
from ves_twin.diagnosis.fit.tolerances import cached_scale, tolerance_scale
from ves_twin.diagnosis.model.forward import Hypothesis, check_forward
from ves_twin.diagnosis.record.preprocess import preprocess
from ves_twin.diagnosis.record.runs import Runs
from ves_twin.diagnosis.record.whitening import whitening_declared
from ves_twin.diagnosis.settings import Settings


@pytest.fixture(scope="module")
def runs():
    return Runs(Toy(), (programme(),), (0, 1))


def test_signatures_are_the_change_at_each_size(runs):
    bank = build_bank(runs)
    friction = 1 + CAUSES.index("friction")
    for k in bank.entries(friction):
        change = runs.forward.simulate(runs.programmes[0], {"friction.size": bank.sizes[k][0]})
        nominal = runs.forward.simulate(runs.programmes[0], {})
        assert bank.signature(k) == pytest.approx(change - nominal, abs=1e-5)


def test_the_screen_finds_the_pair_that_was_added(runs):
    bank = build_bank(runs)
    screen = Screen(bank, whitening_declared(runs))
    names = [h.effect for h in bank.hypotheses]
    a = next(k for k in bank.entries(names.index("drift")) if bank.sizes[k][0] > 0.01)
    b = next(k for k in bank.entries(names.index("bump")) if bank.sizes[k][0] > 0.01)
    z = screen.whitening.apply(bank.signature(a) + 1.3 * bank.signature(b))
    first, second = screen.pairs(z, 3)[0]
    assert {names[first.hypothesis], names[second.hypothesis]} == {"drift", "bump"}
    # the pair explains all of it: its score is the whole of <z, z>
    assert first.score == pytest.approx(z @ screen.metric.project(z), rel=1e-6)


def test_a_cached_bank_is_the_same_and_another_programme_is_another_bank(runs, tmp_path):
    built = cached_bank(runs, tmp_path, lambda: build_bank(runs))
    read = cached_bank(runs, tmp_path, lambda: pytest.fail("built twice"))
    assert np.array_equal(read.bent, built.bent)
    assert np.array_equal(read.factor, built.factor)
    assert np.array_equal(read.owner, built.owner)
    assert all(np.array_equal(a, b) for a, b in zip(read.sizes, built.sizes, strict=True))
    other = Runs(Toy(), (programme(2),), (0, 1))
    assert not np.array_equal(
        cached_bank(other, tmp_path, lambda: build_bank(other)).bent, built.bent
    )
    assert len(list(tmp_path.iterdir())) == 2


def anew(runs):
    """As a later program has it, which remembers no run."""
    return Runs(Toy(), runs.programmes, runs.columns)


def test_a_kept_bank_of_a_plant_whose_code_has_changed_is_built_anew(runs, tmp_path, monkeypatch):
    cached_bank(runs, tmp_path, lambda: build_bank(runs))
    before = Toy.simulate
    monkeypatch.setattr(Toy, "simulate", lambda *a, **k: 1.01 * before(*a, **k))
    later = anew(runs)
    fresh = build_bank(later)
    again = cached_bank(later, tmp_path, lambda: fresh)
    assert again is fresh
    read = cached_bank(later, tmp_path, lambda: pytest.fail("built twice"))
    assert np.array_equal(read.base.prediction, fresh.base.prediction)


@pytest.mark.parametrize("harm", [b"", b"no zip", None], ids=["empty", "other", "a byte"])
def test_what_is_kept_and_damaged_is_made_anew(runs, tmp_path, harm):
    settings = Settings(nulls=8, cache=tmp_path, simulated_nulls=False)
    rng = np.random.default_rng(3)
    rigs = [preprocess(Toy(), [record(rng, spread=2.0)]) for _ in range(3)]

    def kept():
        bank = cached_bank(runs, tmp_path, lambda: build_bank(runs))
        limits = cached_thresholds(bank, whitening_declared(runs), settings)
        scale = cached_scale([(rig.runs, rig.measured) for rig in rigs], tmp_path)
        return bank.bent, limits.effects, scale

    before = kept()
    files = list(tmp_path.glob("*.npz"))
    assert len(files) == 3
    for path in files:
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content if harm is None else harm)
    for old, new in zip(before, kept(), strict=True):
        np.testing.assert_array_equal(new, old)


def test_kept_thresholds_and_scales_of_changed_code_are_not_read(runs, tmp_path, monkeypatch):
    settings = Settings(nulls=8, cache=tmp_path, simulated_nulls=False)
    rng = np.random.default_rng(3)
    rigs = [preprocess(Toy(), [record(rng, spread=2.0)]) for _ in range(3)]

    def measured():
        return [(anew(rig.runs), rig.measured) for rig in rigs]

    def found():
        there = anew(runs)
        bank = cached_bank(there, tmp_path, lambda: build_bank(there))
        limits = cached_thresholds(bank, whitening_declared(there), settings)
        return limits.effects, cached_scale(measured(), tmp_path)

    old, again = found(), found()
    assert np.array_equal(again[0], old[0])
    assert again[1] == old[1]
    before = Toy.simulate
    monkeypatch.setattr(Toy, "simulate", lambda *a, **k: 1.02 * before(*a, **k))
    kept = found()
    later = anew(runs)
    fresh = null_thresholds(build_bank(later), whitening_declared(later), 8, 0.002, simulated=False)
    assert not np.array_equal(kept[0], old[0])
    assert np.array_equal(kept[0], fresh.effects)
    assert kept[1] != old[1]
    assert kept[1] == tolerance_scale(measured())


class Straight(Toy):
    """The gain is a cause that is linear throughout, 20 of its tolerances at most."""

    @property
    def hypotheses(self):
        return (replace(GAIN, largest=(0.4,), linear=True), *map(_cause, self.causes))


def test_a_linear_cause_of_few_tolerances_has_a_size_from_which_it_is_found():
    bank = build_bank(Runs(Straight(), (programme(),), (0, 1)))
    sizes = sorted(float(bank.sizes[k][0]) for k in bank.entries(0))
    assert sizes == pytest.approx([-0.4, -0.08, 0.08, 0.4])  # 4 tolerances, and its largest
    threshold = 19.1  # that of VES II: the root and MARGIN are 4.87 tolerances, beyond the first
    found = findable_sizes(Screen(bank, whitening_declared(bank.base.runs)), threshold)
    goal = np.sqrt(threshold) + MARGIN
    assert found["gain@plant"] == pytest.approx(goal * 0.02, rel=1e-2)  # it shows fully, soon


def test_a_bank_without_causes_is_kept_too(tmp_path):
    bare = Runs(Toy(causes=(), with_gain=False), (programme(),), (0, 1))
    for _ in range(2):
        bank = cached_bank(bare, tmp_path, lambda: build_bank(bare))
        assert (bank.sizes, len(bank.owner), bank.bent.shape[0]) == ((), 0, 0)
    assert len(list(tmp_path.iterdir())) == 1


def test_processes_change_nothing(runs):
    two = Runs(Toy(), (programme(),), (0, 1), Workers(2))
    assert np.array_equal(build_bank(two).bent, build_bank(runs).bent)
    alone = null_thresholds(build_bank(runs), whitening_declared(runs), 6, 0.01)
    shared = null_thresholds(build_bank(two), whitening_declared(two), 6, 0.01)
    assert sorted(alone.effects) == pytest.approx(sorted(shared.effects))


def test_a_library_that_names_what_does_not_exist_is_refused():
    class Wrong(Toy):
        hypotheses = (Hypothesis("friction", "plant", ("fricton.size",), (0.1,), (1.0,)),)

    with pytest.raises(UnknownNameError, match=r"did you mean 'friction\.size'"):
        check_forward(Wrong())

    class PerRun(Toy):
        hypotheses = (Hypothesis("offset", "plant", ("plant.offset",), (0.1,), (1.0,)),)

    with pytest.raises(InvalidInputError, match="of the plant itself"):
        check_forward(PerRun())


def test_thresholds_of_fewer_rigs_for_want_of_time_are_not_kept(runs, tmp_path):
    settings = Settings(nulls=40, cache=tmp_path, simulated_nulls=False)
    budget = Budget()
    budget.tells = True
    assert budget.end()
    late = replace(runs, workers=Workers(1, budget))
    bank = build_bank(runs)
    hurried = replace(bank, base=replace(bank.base, runs=late))
    few = cached_thresholds(hurried, whitening_declared(late), settings)
    assert len(few.effects) == LEAST
    assert not list(tmp_path.glob("*.npz"))
    assert len(cached_thresholds(bank, whitening_declared(runs), settings).effects) == 40
    again = cached_thresholds(hurried, whitening_declared(late), settings)
    assert len(again.effects) == 40  # as they were kept
