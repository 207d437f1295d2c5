"""SweepPlan: points, units and identity, and what is refused before anything runs."""

import math

import pytest

from ves_twin.core.errors import VesTwinError
from ves_twin.plant.plant import Plant
from ves_twin.sweeps.plan import plan_sweep

SCENARIO = "beam_horizontal_truth"


def test_a_grid_has_every_combination_with_the_last_key_fastest():
    plan = plan_sweep(SCENARIO, ["legs.gain=8,12", "seed=0..2:3"])
    assert [point.values for point in plan.points] == [
        (8.0, 0), (8.0, 1), (8.0, 2), (12.0, 0), (12.0, 1), (12.0, 2)
    ]  # fmt: skip
    assert [point.scenario.run.seed for point in plan.points] == [0, 1, 2, 0, 1, 2]
    assert [point.number for point in plan.points] == list(range(6))


def test_every_kind_of_key_has_its_value_in_si_and_its_unit():
    vary = {
        "legs.gain=8": (8.0, "1/s"),
        "run.duration=1 min": (60.0, "s"),
        "run.substeps=2": (2, ""),
        "platform.start=[0,0,0.1,0,0,'3 deg']": ([0, 0, 0.1, 0, 0, math.radians(3)], "m, rad"),
        "arm.start=[0,'90 deg',0]": ([0, math.radians(90), 0], "rad"),
        "platform.emulated=beam_vertical_thesis": ("beam_vertical_thesis", ""),
        "legs.filter=error": ("error", ""),
        "gravity.file=none": None,
        "parameters.leg.rod_mass=2600 g": (2.6, "kg"),
        "effects.payload_mass.rig.mass=1.5": None,
        "effects.length_offset.leg.3.offset=0.001": (0.001, "m"),
    }
    vary = {key: expected for key, expected in vary.items() if expected is not None}
    plan = plan_sweep(SCENARIO, list(vary))
    assert list(plan.keys.values()) == [unit for _, unit in vary.values()]
    for value, (expected, _) in zip(plan.points[0].values, vary.values(), strict=True):
        assert value == (pytest.approx(expected) if isinstance(expected, list) else expected)


def test_random_points_lie_in_their_ranges_and_begin_a_longer_sweep():
    vary = ["legs.gain=8..20", "gravity.age=0..3", "legs.filter=none,error"]
    short, long = (plan_sweep(SCENARIO, vary, number=n, seed=5) for n in (20, 40))
    assert [p.values for p in short.points] == [p.values for p in long.points[:20]]
    gains, ages, filters = zip(*(p.values for p in long.points), strict=True)
    assert all(8.0 <= gain <= 20.0 for gain in gains)
    assert len(set(gains)) == 40
    assert set(ages) == {0, 1, 2, 3}
    assert set(filters) == {"none", "error"}
    assert plan_sweep(SCENARIO, vary, number=20, seed=6).points[0].values != short.points[0].values


BAD = [
    (["legs.gian=3"], "did you mean 'legs.gain'"),
    (["legs.gain=8,-1"], "greater than or equal to 0"),
    (["legs.filter=none,eror"], "did you mean 'error'"),
    (["legs.gain=8..20"], "--random N"),
    (["legs.gain=20..8:3"], "a lower end below"),
    (["gravity.age=0..3:3"], "whole numbers"),
    (["legs.filter=a..b:3"], "known: error, feedback, none"),
    (["legs.gain=1,2", "legs.gain=3"], "each key once"),
    (["legs.gain=1..2:1000", "legs.edge=1..2:1000"], "at most 100000"),
    (["effects.valve_nul.leg.3.null=0.01"], "did you mean 'valve_null'"),
    (["effects.valve_null.leg.7.null=0.01"], "did you mean 'leg."),
    (["parameters.leg.rod_mas=2"], "did you mean 'leg.rod_mass'"),
    (["platform=1,2"], "platform"),
    (["plant=ves2,vse2"], "did you mean 'ves2'"),
    (["platform.emulated=beam"], "emulated model"),
    ([], "one key or more"),
]


@pytest.mark.parametrize(("vary", "says"), BAD, ids=[" ".join(vary) for vary, _ in BAD])
def test_a_bad_key_or_value_is_one_line_before_anything_runs(vary, says):
    with pytest.raises(VesTwinError) as caught:
        plan_sweep(SCENARIO, vary)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_plant_may_be_given_or_varied_but_not_both():
    with pytest.raises(VesTwinError, match="one of them"):
        plan_sweep(SCENARIO, ["plant=ves2,ves2_fast"], plant=Plant.load("ves2"))
    plan = plan_sweep(SCENARIO, ["plant=ves2,ves2_fast"])
    assert len({point.plant_hash for point in plan.points}) == 2


def test_the_identity_knows_what_named_files_hold(tmp_path):
    base = tmp_path / "base.toml"

    def identity(mass: float) -> object:
        base.write_text(
            f"schema = 1\ncoupling = 'beam'\nmass = [{mass}, 20, 20, 5, 3000, 3000]\n"
            "damping = [0, 0, 0, 0, 0, 0]\nstiffness = [300, 300, 300, 3000, 15000, 15000]\n"
        )
        return plan_sweep(SCENARIO, ["seed=1,2"], {"platform.emulated": str(base)}).identity

    assert identity(20.0) == identity(20.0)
    assert identity(20.0) != identity(21.0)


def test_the_identity_knows_what_a_set_point_file_holds_and_misses_it_before_anything_runs(
    tmp_path,
):
    file = tmp_path / "points.csv"

    def identity(row: str) -> object:
        file.write_text(f"t,leg.command.1\n{row}\n")
        return plan_sweep("position_sine", ["seed=1,2"], played).identity

    played = {"platform.motion": {"kind": "setpoints", "file": str(file)}}
    with pytest.raises(VesTwinError, match=r"set-point file .* does not exist"):
        plan_sweep("position_sine", ["seed=1,2"], played)
    assert identity("0,1.0") == identity("0,1.0")
    assert identity("0,1.0") != identity("0,1.1")
