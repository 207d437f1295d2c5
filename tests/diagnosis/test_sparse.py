"""Banks with fewer runs: what is simulated, and that the rest follows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from toy import GAIN, NUISANCES, Toy, _cause, programme

from ves_twin.diagnosis.bank.linearise import linearise, renewed, with_bends
from ves_twin.diagnosis.bank.rungs import rungs
from ves_twin.diagnosis.bank.signature_library import build_bank, cached_bank
from ves_twin.diagnosis.model.forward import Hypothesis, Parameter
from ves_twin.diagnosis.record.runs import Runs

JOINTS = 4
CURVE = 3.0


@dataclass(frozen=True)
class Jointed(Toy):
    """A toy whose gain bends four like tolerances, and that counts its runs."""

    counted: tuple[list[int], ...] = ([],)

    @property
    def parameters(self):
        stiff = (Parameter(f"j{n}.size", "1", 0.0, -5.0, 5.0, sd=0.02) for n in range(JOINTS))
        return (*super().parameters, *stiff)

    @property
    def hypotheses(self):
        kind = _cause("friction")
        stiff = (
            replace(kind, effect="spring", target=f"joint.{n}", parameters=(f"j{n}.size",))
            for n in range(JOINTS)
        )
        return (replace(GAIN, linear=True), *map(_cause, self.causes), *stiff)

    def simulate(self, programme, values, refined=False):
        self.counted[0].append(1)
        rows = super().simulate(programme, values)
        time, gain = programme.time, values.get("plant.gain", 1.0) - 1.0
        for n in range(JOINTS):
            wave = np.sin((n + 1.0) * time)[:, None] * [1.0, 0.0]
            rows = rows + values.get(f"j{n}.size", 0.0) * (1.0 + CURVE * gain) * wave
        return rows


@pytest.fixture
def runs():
    return Runs(Jointed(counted=([],)), (programme(),), (0, 1))


def count(runs):
    return len(runs.forward.counted[0])


def test_what_is_linear_takes_one_run_and_what_is_at_a_bound_takes_one(runs):
    plain = linearise(runs, runs.origin)
    # the point, its refinement, one for the gain, two for each of the others
    assert count(runs) == 2 + 1 + 2 * (len(runs.nuisances) - 1)
    held = replace(NUISANCES[1], low=0.0)
    bound = Runs(Jointed(nuisances=(NUISANCES[0], held, NUISANCES[2]), counted=([],)),
                 runs.programmes, (0, 1))  # fmt: skip
    there = linearise(bound, bound.origin)
    assert count(bound) == count(runs) - 1
    assert there.columns == pytest.approx(plain.columns, abs=1e-5)


def test_like_tolerances_that_are_moved_together_bend_as_they_do_one_by_one(runs):
    base = linearise(runs, runs.origin)
    before = count(runs)
    alone = with_bends(base)
    between = count(runs)
    together = with_bends(base, together=True)
    # the four springs share a run; what only adds, as no toy's tolerance says, would take none
    assert (between - before) - (count(runs) - between) == JOINTS - 1
    springs = slice(3, 3 + JOINTS)
    assert np.all(alone.bends[springs] > 0.0)
    assert together.bends[springs] == pytest.approx(alone.bends[springs], rel=0.2)


@pytest.mark.parametrize(
    ("names", "runs_of_it"), [("table@chamber.{}", 1), ("start@{}:position", 3)]
)
def test_tolerances_of_one_part_share_a_run_and_others_do_not(names, runs_of_it):
    more = tuple(Parameter(names.format(n), "1", 0.0, -5.0, 5.0, sd=0.02) for n in range(3))
    plain = Runs(Jointed(counted=([],)), (programme(),), (0, 1))
    wider = Runs(Jointed(nuisances=(*NUISANCES, *more), counted=([],)), (programme(),), (0, 1))
    counts = []
    for one in (plain, wider):
        base, before = linearise(one, one.origin), count(one)
        with_bends(base, together=True)
        counts.append(count(one) - before)
    assert counts[1] - counts[0] == runs_of_it


@pytest.mark.parametrize(("share", "anew"), [(0.0, 0), (0.1, 0), (3.0, 1), (10.0, 1 + JOINTS)])
def test_columns_are_computed_anew_by_how_far_a_fit_has_moved(runs, share, anew):
    base = with_bends(linearise(runs, runs.origin))
    point = runs.origin.copy()
    point[runs.nuisances] = share * runs.sd[runs.nuisances]
    prediction, before = runs.one(point), count(runs)
    there = renewed(base, point, prediction)
    # the point and its refinement are simulated in any case; the gain's own column bends most
    assert count(runs) - before == 2 + anew
    exact = linearise(runs, point, forward_step=1.0)
    if anew > JOINTS:
        assert there.columns == pytest.approx(exact.columns, abs=1e-3)


def test_sizes_that_are_not_simulated_are_scaled_from_the_nearest(runs):
    full, before = build_bank(runs), count(runs)
    sparse = build_bank(runs, sparse=True)
    assert count(runs) - before < before / 2
    assert len(sparse.bent) < len(full.bent) / 2
    for h in range(len(full.hypotheses)):
        sizes = [[float(bank.sizes[k][0]) for k in bank.entries(h)] for bank in (full, sparse)]
        assert sizes[1] == pytest.approx(sizes[0])
        for a, b in zip(full.entries(h), sparse.entries(h), strict=True):  # a linear plant
            assert sparse.signature(b) == pytest.approx(full.signature(a), abs=1e-4)


def test_a_linear_cause_of_two_parameters_is_simulated_along_each_and_added():
    tilt = Hypothesis("tilt", "rig", ("a", "b"), (0.1, 0.2), (1.0, 2.0), linear=True)
    asked, weights = rungs(tilt, 1)
    assert asked.shape == (2, 2)
    assert np.count_nonzero(asked) == 2
    assert weights @ asked == pytest.approx(tilt.departures())


@pytest.mark.parametrize("signs", [(-1,), (1,), (-1, 1)])
@pytest.mark.parametrize("crowd", [1, 6])
def test_every_size_is_one_of_its_own_sign_scaled(signs, crowd):
    cause = Hypothesis("lag", "leg.1", ("lag",), (0.01,), (1.0,), signs)
    asked, weights = rungs(cause, crowd)
    assert len(asked) == len(signs) * (1 if crowd == 6 else 2)
    assert weights @ asked == pytest.approx(cause.departures())
    assert np.all(weights >= 0.0)
    assert np.all(np.count_nonzero(weights, axis=1) == 1)


@pytest.mark.parametrize(
    ("signs", "crowd", "known", "simulated"),
    [
        ((1,), 6, [0.005], [0.126491]),  # the middle, and what one sd changes
        ((1,), 1, [0.005], [0.8]),
        ((-1, 1), 6, [], [0.02]),  # one small size for both signs
        ((-1, 1), 1, [], [-0.8, 0.02]),
    ],
)
def test_a_bank_scales_small_sizes_from_what_it_has_already(signs, crowd, known, simulated):
    cause = Hypothesis("lag", "leg.1", ("lag",), (0.01,), (1.0,), signs)
    asked, weights = rungs(cause, crowd, np.array(known))
    assert asked[:, 0] == pytest.approx(simulated, rel=1e-4)
    traces = np.concatenate([asked[:, 0], known])
    sizes = cause.departures()[:, 0]
    assert weights @ traces == pytest.approx(sizes)
    assert np.all(np.count_nonzero(weights, axis=1) == 1)
    least = np.argmin(np.abs(sizes))
    assert abs(traces[np.argmax(np.abs(weights[least]))]) <= 0.02


def test_a_linear_cause_whose_parameters_are_all_tolerances_takes_no_run():
    tilt = Hypothesis("tilt", "rig", ("a", "b"), (0.1, 0.2), (1.0, 2.0), linear=True)
    asked, weights = rungs(tilt, 1, np.array([0.02, 0.05]))
    assert asked.shape == (0, 2)
    assert weights @ np.diag([0.02, 0.05]) == pytest.approx(tilt.departures())


def test_entries_of_a_tilt_are_sums_of_the_columns_of_its_tolerances(runs):
    tilt = Hypothesis("tilt", "rig", ("j0.size", "j1.size"), (0.1, 0.1), (1.0, 1.0), linear=True)
    base, before = linearise(runs, runs.origin), count(runs)
    bank = build_bank(runs, hypotheses=(tilt,), base=base, sparse=True)
    assert count(runs) == before
    assert len(bank.owner) == len(tilt.departures())
    for entry in range(len(bank.owner)):
        exact = runs.one(runs.depart(runs.origin, runs.indices(tilt), bank.sizes[entry]))
        assert bank.signature(entry) == pytest.approx(exact - base.prediction, abs=1e-4)


def test_a_sparse_bank_is_not_taken_for_a_full_one(runs, tmp_path):
    sparse = cached_bank(runs, tmp_path, lambda: build_bank(runs, sparse=True), "sparse")
    full = cached_bank(runs, tmp_path, lambda: build_bank(runs))
    again = cached_bank(runs, tmp_path, lambda: pytest.fail("built anew"), "sparse")
    assert len(full.bent) > len(sparse.bent)
    assert np.array_equal(again.bent, sparse.bent)
