"""Sets of rigs: frozen draws, bounds, and messages."""

import numpy as np
import pytest

from ves_twin.core.errors import InvalidInputError, UnknownNameError, VersionError
from ves_twin.effects.registry import EFFECTS, targets_of
from ves_twin.envs.rig_set import RigSet, commissioned
from ves_twin.plant.plant import Plant

SETS = ("train-v0", "test-v0")


def rng(seed):
    return np.random.default_rng([seed, 1])


@pytest.mark.parametrize("name", SETS)
def test_a_seed_gives_one_rig(name):
    plant, rigs = Plant.load("ves2"), RigSet.load(name)
    assert rigs.draw(plant, rng(3)).hash == rigs.draw(plant, rng(3)).hash
    assert len({rigs.draw(plant, rng(k)).hash for k in range(20)}) == 20


def test_test_rigs_have_kinds_that_training_never_shows():
    train, test = ({e.kind for e in RigSet.load(name).effects} for name in SETS)
    assert {"payload_mass", "hose_stiffness", "valve_deadband"} <= test - train


@pytest.mark.parametrize("name", SETS)
def test_shares_are_those_of_the_file(name):
    rigs = RigSet.load(name)
    count = 300
    drawn = [rigs.draw(Plant.load("ves2"), rng(k)).effects for k in range(count)]
    for wanted in rigs.effects:
        kind, targets = EFFECTS[wanted.kind].kind, wanted.targets or targets_of(wanted.kind)
        found = sum((e.kind, e.target in targets) == (kind, True) for rig in drawn for e in rig)
        tries = count * len(targets)
        spread = np.sqrt(tries * wanted.share * (1 - wanted.share))
        assert abs(found - tries * wanted.share) <= 4 * spread  # four sd of a binomial


def test_commissioning_errors_have_the_declared_size():
    plant = Plant.load("ves2")
    draws = np.array(
        [
            commissioned(plant, {"arm.mass": 2.0}, rng(k)).parameters.array("arm.mass")
            for k in range(400)
        ]
    )
    sd = np.std(draws - plant.parameters.array("arm.mass"), axis=0)
    np.testing.assert_allclose(
        sd, 2.0 * np.array([0.5, 0.2, 0.2, 0.1]), rtol=0.15
    )  # 400 draws: 3.5 %


HEAD = 'schema = 1\nsource = "a test"\n'


@pytest.mark.parametrize(
    ("text", "error", "words"),
    [
        ("schema = 2\n", VersionError, "schema"),
        (HEAD + '[[effects]]\nkind = "valve_nul"\nsizes = {}\n', InvalidInputError, "valve_null"),
        (
            HEAD + '[[effects]]\nkind = "valve_null"\nsizes = { nul = { sd = 1.0 } }\n',
            InvalidInputError,
            "did you mean 'null'",
        ),
        (
            HEAD + '[[effects]]\nkind = "valve_null"\nsizes = { null = { low = 1.0 } }\n',
            InvalidInputError,
            "low and high, or sd",
        ),
        (
            HEAD
            + '[[effects]]\nkind = "valve_null"\ntargets = ["leg.7"]\nsizes = { null = { sd = 1.0 } }\n',
            InvalidInputError,
            "leg.6|leg.1",
        ),
        (HEAD + '[commissioning]\n"arm.mas" = 1.0\n', UnknownNameError, "arm.mass"),
        (HEAD + "effect = 1\n", UnknownNameError, "effects"),
    ],
)
def test_a_file_that_is_wrong_is_answered_in_one_line(tmp_path, text, error, words):
    path = tmp_path / "set.toml"
    path.write_text(text)
    with pytest.raises(error, match=words) as caught:
        RigSet.load(str(path))
    assert "\n" not in str(caught.value)


def test_an_exact_parameter_cannot_be_off():
    with pytest.raises(InvalidInputError, match="sd"):
        commissioned(Plant.load("ves2"), {"leg.stroke": 1.0}, rng(0))


def test_an_unknown_set_is_answered_with_the_nearest():
    with pytest.raises(UnknownNameError, match="did you mean 'test-v0'"):
        RigSet.load("test-v")
