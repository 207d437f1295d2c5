"""A cause with numbers that do nothing is told as the one without them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import linear
import numpy as np
import pytest
from linear import JOINTS, PERIOD, Linear, motion, recorded, seen

from ves_twin.diagnosis.build_up.halves import halves_at
from ves_twin.diagnosis.build_up.judges import ERRORS, Judges
from ves_twin.diagnosis.build_up.proof import prove
from ves_twin.diagnosis.build_up.simpler import simpler
from ves_twin.diagnosis.build_up.trials import Trial
from ves_twin.diagnosis.model.forward import Excitation, Hypothesis, Parameter


@dataclass(frozen=True)
class Falling(Linear):
    """With dry friction that falls by exp(-(v / speed)^2)."""

    kinds: tuple[str, ...] = ("viscous", "coulomb")

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        more = [
            Parameter(f"falling@{j}:{name}", "1", 0.0, -50.0, 50.0)
            for j in JOINTS
            for name in ("level", "speed")
        ]
        return (*super().parameters, *more)

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        names = {j: (f"falling@{j}:level", f"falling@{j}:speed") for j in JOINTS}
        more = tuple(
            Hypothesis("falling", j, names[j], (0.1, 0.1), (2.0, 30.0), starts=((1.0, 1.0),))
            for j in JOINTS
        )
        return (*super().hypotheses, *more)

    def simulate(
        self, programme: Excitation, values: Mapping[str, float], refined: bool = False
    ) -> np.ndarray:
        rows = super().simulate(programme, values, refined)
        for c, joint in enumerate(JOINTS):
            level, speed = (values.get(f"falling@{joint}:{n}", 0.0) for n in ("level", "speed"))
            v = np.gradient(programme.drive["q"][:, c], PERIOD)
            if level and speed:
                rows[:, c] += level * np.tanh(v / 0.02) * np.exp(-np.square(v / speed))
        return rows


def told(speed: float) -> set[str]:
    """What a proof of falling friction comes to, of a machine whose friction falls over a speed."""
    plant = Falling()
    hidden = {"falling@a:level": 0.8, "falling@a:speed": speed}
    one, two = (seen(plant, recorded(plant, hidden, seed)) for seed in (5, 6))
    cause = next(h for h in plant.hypotheses if h.label == "falling@a")
    present = (Trial(cause, (0.8, speed), positive=True),)
    halves = halves_at(one, two, one.runs.origin, plant.hypotheses, present)
    regression = halves.regression
    chosen = [n for n, trial in enumerate(regression.trials) if trial in present]
    proof = prove(regression, halves.held, chosen)
    assert len(proof.proved) == 1
    after = simpler(proof)
    tried = after.tested - proof.tested  # one trial for each that could take its place
    assert tried <= 1
    return {regression.trials[n].cause.label for n in after.proved}


@pytest.mark.parametrize(("speed", "label"), [(30.0, "coulomb@a"), (0.6, "falling@a")])
def test_friction_that_falls_beyond_the_speeds_of_a_record_is_coulomb_friction(speed, label):
    assert told(speed) == {label}


def test_a_simpler_cause_that_was_dropped_before_counts_once_and_is_proved_now():
    plant, hidden = Falling(), {"falling@a:level": 0.8, "falling@a:speed": 30.0}
    one, two = (seen(plant, recorded(plant, hidden, seed)) for seed in (5, 6))
    labels = {h.label: h for h in plant.hypotheses}
    present = (Trial(labels["falling@a"], (0.8, 30.0), positive=True),)
    halves = halves_at(one, two, one.runs.origin, plant.hypotheses, present)
    trials = halves.regression.trials
    falling = next(n for n, trial in enumerate(trials) if trial in present)
    dry = next(n for n, trial in enumerate(trials) if trial.cause.label == "coulomb@a")
    proof = prove(halves.regression, halves.held, [falling])
    before = replace(proof, dropped={dry: 0.3}, tested=2)
    after = simpler(before)
    assert after.proved == (dry,)
    assert dry not in after.dropped
    assert after.tested == before.tested


@pytest.mark.parametrize("kind", ERRORS)
def test_what_takes_a_causes_place_is_proved_by_the_errors_that_proved_the_cause(kind):
    """Not by those that would show it best by itself: two proofs would then be compared."""
    plant, hidden = Falling(), {"falling@a:level": 0.8, "falling@a:speed": 30.0}
    one, two = (seen(plant, recorded(plant, hidden, seed)) for seed in (5, 6))
    cause = next(h for h in plant.hypotheses if h.label == "falling@a")
    present = (Trial(cause, (0.8, 30.0), positive=True),)
    halves = halves_at(one, two, one.runs.origin, plant.hypotheses, present)
    trials = halves.regression.trials
    falling = next(n for n, trial in enumerate(trials) if trial in present)
    judges = Judges.of(halves.regression, [falling], (kind,))
    after = simpler(prove(halves.regression, halves.held, [falling], judges=judges))
    assert [trials[n].cause.label for n in after.proved] == ["coulomb@a"]
    (bench,) = after.judges.benches
    assert (bench.memory, bench.even) == kind


def onward(seed: int) -> Excitation:
    """A motion that goes on one way, faster and slower."""
    there = motion(seed)
    return replace(there, drive={"q": there.drive["q"] + 6.0 * there.time[:, None]})


@pytest.mark.parametrize(
    ("path", "hidden", "told"),
    [
        (onward, "viscous_asymmetry", "viscous_friction"),  # the same there
        (motion, "viscous_asymmetry", "viscous_asymmetry"),
        (motion, "viscous_friction", "viscous_friction"),
    ],
)
def test_a_friction_by_direction_is_the_usual_one_where_motion_goes_one_way(
    monkeypatch, path, hidden, told
):
    monkeypatch.setattr(linear, "motion", path)
    plant = Linear(("viscous_friction", "viscous_asymmetry"))
    one, two = (seen(plant, recorded(plant, {f"{hidden}@a:size": 1.0}, s)) for s in (5, 6))
    halves = halves_at(one, two, one.runs.origin, plant.hypotheses)
    trials = halves.regression.trials
    chosen = next(n for n, trial in enumerate(trials) if trial.cause.label == f"{hidden}@a")
    after = simpler(prove(halves.regression, halves.held, [chosen]))
    assert [trials[n].cause.label for n in after.proved] == [f"{told}@a"]
