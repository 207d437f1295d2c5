"""Learning Method on the fast rig: what it finds, what cannot hurt it, what does, what it refuses."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError
from ves_twin.mechanics.gravity.learned import LearnedGravity
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure
from ves_twin.simulator.outcome import Outcome

SHORT = {
    "experiment": "beam_horizontal_truth",
    "duration": 4.0,
    "alpha": 10.0,
    "iterations": 3,
    "noise_grade": 0.0,
    "drift_grade": 0.0,
}
"""The move of the thesis and 1.5 s after it, without noise; alpha of 10 to save time."""


def learned(folder, plant=None, **changes):
    procedure = load_procedure("beam_learning_method", {**SHORT, **changes})
    return procedure.carry_out(RunContext(folder, plant or vt.Plant.load("ves2_fast")))


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    folder = tmp_path_factory.mktemp("learned")
    return learned(folder), folder


def mm(values, key):
    return 1e3 * np.linalg.norm(np.array(values[key])[:3])


@pytest.mark.slow
def test_changes_fall_below_a_millimetre_and_the_motion_is_that_of_exact_gravity(plain):
    account, folder = plain
    changes = [one["translation"] for one in account.values["iterations"]]
    assert changes[0] > 0.05  # m: the whole motion, since Y^0 is none
    assert account.values["settled_after"] == 3
    assert mm(account.values, "lost_against_gravity_known_exactly") < 0.3  # of 112 mm
    assert account.values["rig_time"] == pytest.approx(3 * 11 * 4.0)  # (alpha + 1) each
    names = {p.name for p in folder.iterdir()}
    pictures = {"convergence.png", "agreement.png"}
    assert names == pictures | {"learned_gravity.parquet", "convergence.csv", "motion.csv"}


@pytest.mark.nightly
def test_wrong_gains_and_a_tilted_base_do_not_hurt_it_but_the_model_method(plain, tmp_path):
    """Reading and W_g have the same error: only the dynamic wrench keeps it, 1 % here."""
    crossed = vt.Plant.load("ves2_crosstalk").with_fidelity("fast")
    world = crossed.with_values({"platform.level": np.radians([0.5, -0.5])})
    wrong = learned(tmp_path, world).values
    right = plain[0].values
    assert wrong["settled_after"] == 3
    error = mm(wrong, "error_against_zero-g")
    assert error < mm(right, "error_against_zero-g") + 0.5  # mm
    scenario = vt.Scenario.load("beam_horizontal_truth", {"gravity.method": "model"})
    scenario = scenario.model_copy(
        update={"run": scenario.run.model_copy(update={"duration": 4.0})}
    )
    run = vt.simulate(scenario, world)
    rows = run["truth.pose"] - run["reference.pose"]
    assert 1e3 * np.sqrt(np.mean(np.sum(rows[:, :3] ** 2, axis=1))) > 2.0 * error


@pytest.mark.nightly
def test_friction_of_the_legs_that_does_not_repeat_hurts_and_it_says_what_was_lost(plain, tmp_path):
    account = learned(tmp_path, vt.Plant.load("ves2_fast").with_values({"leg.dry_friction": 20.0}))
    assert account.values["settled_after"] is None
    assert any("not learned" in line for line in account.lines)
    lost = "lost_against_gravity_known_exactly"
    assert mm(account.values, lost) > 10.0 * mm(plain[0].values, lost)


@pytest.mark.nightly
def test_a_simulated_guess_saves_iterations(tmp_path):
    account = learned(tmp_path, guess="simulated", iterations=1, compare=False)
    assert account.values["iterations"][0]["translation"] < 2e-3  # m; 112 mm without a guess


@pytest.mark.slow
def test_an_iterate_that_leaves_the_workspace_ends_it_with_a_name(tmp_path):
    account = learned(tmp_path, experiment="beam_horizontal_corrected")
    assert account.outcome in (Outcome.WRENCH_RANGE, Outcome.LEG_LIMIT)
    assert account.values["iterations"] == []
    assert any("ended in iteration 1" in line for line in account.lines)
    kept = LearnedGravity.load(str(tmp_path / "learned_gravity.parquet"))
    assert np.all(np.isfinite(kept.wrenches))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"experiment": "teleoperation"}, "operator are not known in advance"),
        ({"experiment": "position_sine"}, "platform.emulated"),
    ],
)
def test_what_cannot_be_learned_is_refused_before_anything_is_written(tmp_path, change, message):
    with pytest.raises(InvalidInputError, match=message):
        learned(tmp_path, **change)
    assert list(tmp_path.iterdir()) == []
