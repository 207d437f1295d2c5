"""Stepper: what resists in compiled code does so as the same formula, written in Python, does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import cos, exp, sin

import numpy as np
import pytest
from two_link import programme, rig

from ves_twin.core.types import FloatArray
from ves_twin.effects.effect import Effect
from ves_twin.effects.element import Element
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.effects.registry import EFFECTS
from ves_twin.effects.resistance import Form, Resistance
from ves_twin.effects.row import Anywhere
from ves_twin.machines.mjcf.motion.stepping import motion_of_drive
from ves_twin.machines.mjcf.motion.work import Work
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.places import place_of

Speeds = Callable[[FloatArray, float], FloatArray]


@dataclass(frozen=True)
class Own(Effect):
    """An effect of another package: hooks in Python."""

    speeds: Speeds | None = None
    places: Callable[[], Callable[[float], float]] | None = None
    share: float = 0.0

    kind = "own"
    anywhere = Anywhere(Element.JOINT)

    def __post_init__(self) -> None:
        """No size to check."""

    def resist(self, speed: FloatArray, slow: float) -> FloatArray:
        return self.speeds(speed, slow) if self.speeds else np.zeros_like(speed)

    def holder(self) -> Callable[[float], float]:
        return self.places() if self.places else lambda q: 0.0

    def carry(self, load: FloatArray, speed: FloatArray, slow: float) -> FloatArray:
        return self.share * np.abs(load) * np.tanh(speed / slow)


def slider(level: float, difference: float, travel: float, gap: float) -> Callable[[float], float]:
    where: list[float] = []

    def effort(q: float) -> float:
        where[:] = where or [q]
        apart = q - where[0]
        share = np.sign(apart) * max(abs(apart) - 0.5 * gap, 0.0) / travel
        held = min(max(share, difference - 1.0), difference + 1.0)
        where[0] += (share - held) * travel
        return level * held

    return effort


def creeping(level: float, travel: float) -> Callable[[float], float]:
    last: list[tuple[float, float]] = []

    def effort(q: float) -> float:
        force = 0.0
        if last:
            before, begun = last[0]
            side = level if q > begun else -level
            force = side - (side - before) * exp(-abs(q - begun) / travel)
        last[:] = [(force, q)]
        return force

    return effort


SAME = {
    "quadratic_drag": ({"drag": 2.0}, Own("rail", lambda v, s: 2.0 * v * np.abs(v))),
    "viscous_asymmetry": ({"slope": 1.5}, Own("rail", lambda v, s: 1.5 * np.abs(v))),
    "coulomb_asymmetry": ({"level": 0.4}, Own("rail", lambda v, s: 0.4 * np.tanh(v / s) ** 2)),
    "force_offset": ({"offset": 1.5}, Own("rail", lambda v, s: np.full_like(v, 1.5))),
    "stribeck_friction": (
        {"level": 0.5, "fall": 0.1},
        Own("rail", lambda v, s: 0.5 * np.exp(-((v / 0.1) ** 2)) * np.tanh(v / s)),
    ),
    "regularized_friction": (
        {"level": 0.6, "transition": 0.2},
        Own("rail", lambda v, s: 0.6 * np.tanh(v / max(0.2, s))),
    ),
    "friction_behind_gap": (
        {"level": 0.8, "difference": 0.2, "travel": 0.02, "gap": 0.05},
        Own("rail", places=lambda: slider(0.8, 0.2, 0.02, 0.05)),
    ),
    "one_way_load": (
        {"load": -1.0, "travel": 0.03},
        Own("rail", places=lambda: slider(0.5, -1.0, 0.015, 0.0)),
    ),
    "dahl_friction": (
        {"level": 0.7, "travel": 0.02}, Own("rail", places=lambda: creeping(0.7, 0.02)),
    ),
    "ripple": (
        {"cosine": 0.3, "sine": -0.2},
        Own("rail", places=lambda: lambda q: 0.3 * cos(40.0 * q) - 0.2 * sin(40.0 * q)),
    ),
    "load_friction": ({"share": 0.1}, Own("rail", share=0.1)),
}  # fmt: skip
"""Kind -> sizes at the rail, and the same in Python."""


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    machine = rig(tmp_path_factory.mktemp("rig"), "control")
    return Work.begin(machine, programme(), {})


def moved(work: Work, *effects: Effect) -> FloatArray:
    place = place_of(built_in("force_offset"), work.rig.description, work.rig.model)
    at_work = replace(work, effects=tuple((e, place) for e in effects))
    return motion_of_drive(at_work, Mode.CONTROL).path


def built_in(kind: str) -> Effect:
    target = "rail.40" if kind == "ripple" else "rail"
    return EFFECTS[kind](target, **SAME[kind][0])


@pytest.mark.parametrize("kind", SAME)
def test_compiled_and_in_python_a_resistance_moves_the_machine_the_same(work, kind):
    compiled, python = moved(work, built_in(kind)), moved(work, SAME[kind][1])
    np.testing.assert_allclose(compiled, python, atol=1e-9)
    assert np.max(np.abs(compiled - moved(work))) > 1e-4


def test_several_of_them_add_up_in_either(work):
    kinds = ("quadratic_drag", "stribeck_friction", "dahl_friction", "ripple")
    both = [moved(work, *(built_in(k) for k in kinds)), moved(work, *(SAME[k][1] for k in kinds))]
    mixed = moved(
        work, built_in(kinds[0]), SAME[kinds[1]][1], built_in(kinds[2]), SAME["ripple"][1]
    )
    np.testing.assert_allclose(*both, atol=1e-9)
    np.testing.assert_allclose(both[0], mixed, atol=1e-9)


STOP = Law("rail", LawKind.EFFORT, LawShape.STOP, ("position@rail",), (), (0.02, 1, 50, 1, 0.8))
"""A contact that bears most of what pushes against it."""


def test_a_contact_knows_its_load_from_step_to_step(work):
    """Stepped one by one, beside hooks in Python, as in one call."""
    lawful = replace(work, laws=(STOP,))
    one, other = (moved(lawful, e) for e in (built_in("quadratic_drag"), SAME["quadratic_drag"][1]))
    np.testing.assert_allclose(one, other, atol=1e-9)
    assert np.max(np.abs(one - moved(work, built_in("quadratic_drag")))) > 1e-2


def test_every_kind_that_has_a_form_is_held_against_its_formula():
    forms = {
        kind for kind, cls in EFFECTS.items()
        if cls.anywhere is not None and cls.resistance is not Effect.resistance
    }  # fmt: skip
    assert forms == set(SAME)
    assert {built_in(kind).resistance.form for kind in SAME} == set(Form) - {Form.NONE}


def test_no_resistance_is_none_at_any_speed_place_and_load():
    x = np.linspace(-1.0, 1.0, 5)
    none = Resistance()
    efforts = [none.by_speed(x, 1e-3), none.by_place(x), none.by_load(x, x, 1e-3)]
    np.testing.assert_array_equal(efforts, np.zeros((3, 5)))
