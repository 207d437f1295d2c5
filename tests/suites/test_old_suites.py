"""Suites, recipes and answers from before machines were called so, and the pendulum was MJCF."""

import json

import pytest

from ves_twin.suites.answers import read_answers
from ves_twin.suites.judgement import Judgement, judge
from ves_twin.suites.pinned import FILE, pinned_recipe
from ves_twin.suites.recipe import Recipe
from ves_twin.suites.seal import new_key, seal
from ves_twin.suites.suite import load_suite
from ves_twin.suites.truth import Hidden, Truth

TRUTH = {
    "case": "case-0001",
    "hidden": "single",
    "causes": [
        {
            "effect": "joint_stiffness",
            "target": "joint",
            "departures": {"joint.stiffness": 0.02},
            "d": 12.0,
        }
    ],
    "outside": "",
    "outside_size": 0.0,
    "spread": 1.0,
    "values": {"joint.stiffness": 0.02, "drive.offset": 0.001},
    "background": {},
    "stand_ins": [["link_mass@link", "torque_gain@drive"]],
    "repaired": False,
}


def test_a_public_part_that_says_bench_names_its_machine(tmp_path):
    old = {"bench": "pendulum", "cases": ["case-0001"], "excluded": {}, "schema": 1}
    (tmp_path / "suite.json").write_text(json.dumps(old))
    suite = load_suite(tmp_path)
    assert suite.machine == "pendulum"
    suite.save(tmp_path)
    assert "bench" not in json.loads((tmp_path / "suite.json").read_text())
    assert load_suite(tmp_path) == suite


def test_a_truth_has_the_names_of_today_and_an_offset_the_sign_of_today():
    truth = Truth.from_json(json.dumps(TRUTH))
    assert truth.labels == {"joint_spring@joint"}
    assert truth.causes[0].departures == {"joint_spring@joint:stiffness": 0.02}
    assert truth.values["force_offset@joint:offset"] == pytest.approx(-0.001)
    assert truth.aliases == (("body_mass@link", "actuator_gain@drive"),)
    assert Truth.from_json(truth.to_json()) == truth


def test_answers_are_judged_under_either_name(tmp_path):
    answer = {
        "verdict": "named",
        "causes": ["joint_stiffness@joint"],
        "sizes": {"joint_stiffness@joint:joint.stiffness": [0.02, 0.01, 0.03, 0.0]},
        "programmes": {"let go from 0.6 rad": 100.0},
    }
    (tmp_path / "answers.json").write_text(json.dumps({"case-0001": answer}))
    said = read_answers(tmp_path / "answers.json")["case-0001"]
    assert judge(said, Truth.from_json(json.dumps(TRUTH)).labels, outside=False) is Judgement.RIGHT
    assert set(said.sizes) == {"joint_spring@joint:stiffness"}
    assert set(said.programmes) == {"let go from 0.6 of the travel"}


def test_a_suite_that_was_begun_with_a_bench_goes_on(tmp_path):
    key, recipe = new_key(), Recipe("pendulum", {Hidden.NONE: 1}, 4)
    begun = {"bench": "pendulum", "counts": {"none": 1}, "seed": 4, "spread": 1.0}
    begun |= {"commissioned": 0, "background": {}, "baseline": False, "cut": False}
    begun |= {"poor": False, "repaired": False}
    (tmp_path / FILE).write_bytes(seal(json.dumps(begun), key))
    assert pinned_recipe(recipe, tmp_path, key) == recipe
