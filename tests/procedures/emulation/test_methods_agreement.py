"""Both gravity methods against each other, beside what their error budgets predict."""

import numpy as np
import pytest

import ves_twin as vt
from ves_twin.core.errors import InvalidInputError
from ves_twin.procedures.emulation.error_sources import GRAVITY_SOURCES, ErrorSources
from ves_twin.procedures.emulation.methods_agreement import agreement
from ves_twin.procedures.procedure import RunContext
from ves_twin.procedures.registry import load_procedure

COVERAGE = 2.0
"""One draw of slow noise has few degrees of freedom: even with one, its rms stays below twice the
budget's 95 times in 100."""

SHORT = {"duration": 4.0, "alpha": 10.0, "draws": 1}
LEARNING_SOURCES = ("rest", "sensor noise", "drift", "gains and level")
"""What the learned W_g gets wrong."""


def test_mean_squares_add_over_sources_and_over_methods():
    budgets = {
        "Learning": {"a": np.full(6, 9.0), "b": np.full(6, 16.0)},
        "Model": {"c": np.full(6, 144.0)},
    }
    table = agreement(np.full(6, 26.0), budgets)
    assert table["Learning: budget"] == pytest.approx([5.0] * 6)
    assert table["Model: c"] == pytest.approx([12.0] * 6)
    assert table["both budgets"] == pytest.approx([13.0] * 6)
    assert table["ratio"] == pytest.approx([2.0] * 6)


@pytest.mark.nightly
def test_the_methods_differ_by_no_more_than_their_budgets_predict(tmp_path):
    values = load_procedure("methods_agreement", SHORT).carry_out(RunContext(tmp_path)).values
    ratio = np.array(values["ratio"])
    assert np.all(ratio < COVERAGE)
    assert np.max(ratio) > 0.1  # or the budgets would tell nothing
    rms = values["rms"]
    for method, sources in (("Learning", LEARNING_SOURCES), ("Model", GRAVITY_SOURCES)):
        assert {f"{method}: {name}" for name in sources} <= set(rms)
    heard = {m: 1e3 * np.linalg.norm(rms[f"{m}: sensor noise"][:3]) for m in ("Learning", "Model")}
    assert heard["Learning"] > heard["Model"]  # phase A's slow noise is played alpha times as fast
    names = {p.name for p in tmp_path.iterdir()}
    assert {"agreement.csv", "agreement.png", "learned_gravity.parquet"} <= names


@pytest.mark.slow
def test_the_gravity_sources_alone_are_those_of_the_whole_budget():
    fast = vt.Plant.load("ves2_fast")
    real = vt.Plant.load("ves2_crosstalk_fast")
    sources = ErrorSources("beam_model_method", {"run.duration": 1.0}, real, fast, 0)
    alone = sources.gravity_parts(lambda share, what: None)
    whole = sources.parts(lambda share, what: None)
    assert set(alone) == set(GRAVITY_SOURCES)
    for name in GRAVITY_SOURCES:
        np.testing.assert_array_equal(alone[name], whole[name])


def test_what_cannot_be_learned_is_refused(tmp_path):
    procedure = load_procedure("methods_agreement", {**SHORT, "experiment": "teleoperation"})
    with pytest.raises(InvalidInputError, match="not known in advance"):
        procedure.carry_out(RunContext(tmp_path))
    assert list(tmp_path.iterdir()) == []
