"""The attack itself: it notices what it is for, and a good file passes it."""

import os
import sys
import time
import warnings
from pathlib import Path

import attack_inputs
import numpy as np
import pytest
from attack_inputs import attack

from ves_twin.core.errors import InvalidInputError, VesTwinWarning


def read(path):
    return path.read_bytes()


def refused(path):
    raise InvalidInputError(path.name, "rubbish", "a file")


def raised(path):
    raise KeyError(path.name)


def two_lines(path):
    raise InvalidInputError("a\nb", 1, "2")


def hangs(path):
    time.sleep(60.0)


def dies(path):
    os._exit(7)


def warns(path):
    warnings.warn("overflow", RuntimeWarning, stacklevel=1)


def tells(path):
    warnings.warn("rows after 1 s are left out", VesTwinWarning, stacklevel=1)


def warns_and_refuses(path):
    warns(path)
    refused(path)


def prints(path):
    os.write(2, b"Exception ignored in ...\n")


def leaves(path):
    (path.parent / "core").write_bytes(b"")


def fills(path):
    np.ones(150_000_000)


@pytest.mark.parametrize(
    ("use", "outcome", "fault"),
    [
        (read, "read", ""),
        (refused, "refused", ""),
        (raised, "KeyError", "KeyError: 'emulated.toml'; test_attack.py"),
        (two_lines, "refused", "characters"),
        (hangs, "hung", "no answer"),
        (dies, "died", "code 7"),
        (warns, "read", "warns: RuntimeWarning overflow"),
        (tells, "read", ""),
        (warns_and_refuses, "refused", ""),
        (prints, "read", "on stderr: Exception ignored"),
        (leaves, "read", "left ['core']"),
        (fills, "read", " MB"),
    ],
    ids=lambda value: getattr(value, "__name__", ""),
)
def test_what_becomes_of_an_input_is_noticed(use, outcome, fault, monkeypatch):
    monkeypatch.setattr(attack_inputs, "SECONDS", 2.0 if use is hangs else 60.0)
    (found,) = attack("emulated.toml", range(5, 6), use)
    assert found.outcome == outcome
    assert fault in found.fault
    assert bool(found.fault) == bool(fault)


def test_the_rest_is_tried_where_an_input_kills_the_process():
    assert [one.outcome for one in attack("emulated.toml", range(3), dies)] == ["died"] * 3


@pytest.mark.parametrize("name", ["scenario.toml", "lab.mcap", "lab.parquet"])
def test_a_seed_gives_the_same_input(name):
    seen = []
    for _ in range(2):
        (found,) = attack(name, range(11, 12), lambda path: refuse_with(path))
        seen.append(found.fault)
    assert seen[0] == seen[1] != ""


def refuse_with(path: Path) -> None:
    raise KeyError(hash_of(path))


def hash_of(path: Path) -> str:
    import hashlib

    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="peak memory is read from /proc")
def test_some_inputs_of_every_kind_pass():
    from kinds import KINDS

    for kind in KINDS:
        for one in attack(kind.name, range(2)):
            assert not one.fault, one
