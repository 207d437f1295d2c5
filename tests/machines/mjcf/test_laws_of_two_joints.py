"""Laws of two joints together, and of where a joint stands within a play: as physics has them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from arm import arm, motion
from numpy.testing import assert_allclose

from ves_twin.core.errors import UnknownNameError, VesTwinError
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.effects import FrictionBehindGap
from ves_twin.effects.law import Law, LawKind, LawShape, variable_along
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode

COUPLED = {"coupling_viscous": "sum difference", "joint_spring": "a", "friction_behind_gap": "a b"}
LEVEL, TRAVEL, GAP = 1.5, 0.05, 0.1

HELD = 0.05
"""Share of what it changes that a law may be off: it is held over a step of 1 ms, a tendon's
damping is implicit."""


@pytest.fixture(scope="module")
def forwards(tmp_path_factory: pytest.TempPathFactory) -> dict[Mode, MjcfForward]:
    rig = arm(tmp_path_factory.mktemp("arm"), COUPLED)
    return {mode: MjcfForward.of(rig, mode) for mode in (Mode.MOTION, Mode.CONTROL)}


def fed(mode: Mode) -> Excitation:
    time, angles = motion(4.0, 1)
    columns = angles if mode is Mode.MOTION else 2.0 * angles
    names = ("qa", "qb") if mode is Mode.MOTION else ("ta", "tb")
    return Excitation("", time, {n: columns[:, [k]] for k, n in enumerate(names)})


def effort(place: str, of: str, knots: tuple[float, ...], values: tuple[float, ...]) -> Law:
    return Law(place, LawKind.EFFORT, LawShape.TABLE, (of,), (knots,), values)


PAIRS = pytest.mark.parametrize(("tendon", "pair"), [("sum", "a + b"), ("difference", "a - b")])


def damped(forward: MjcfForward, tendon: str, pair: str, refined: bool = False) -> list[np.ndarray]:
    """By a tendon, by a law, and not at all."""
    programme = fed(forward.mode)
    law = effort(pair, f"speed@{pair}", (-50.0, 50.0), (5.0, -5.0))
    values = {f"coupling_viscous@{tendon}:damping": 0.1}
    return [
        forward.simulate(programme, values, refined),
        forward.simulate(programme, {}, refined, (law,)),
        forward.simulate(programme, {}, refined),
    ]


@PAIRS
def test_a_law_of_two_joints_together_is_the_damping_of_a_tendon_over_both(
    forwards: dict[Mode, MjcfForward], tendon: str, pair: str
) -> None:
    by_tendon, by_law, plain = damped(forwards[Mode.MOTION], tendon, pair)
    assert_allclose(by_law, by_tendon, atol=1e-9)
    assert np.max(np.abs(by_tendon - plain)) > 0.1


@PAIRS
def test_simulated_forward_it_is_that_tendon_but_for_the_step_over_which_its_effort_is_held(
    forwards: dict[Mode, MjcfForward], tendon: str, pair: str
) -> None:
    off = []
    for refined in (False, True):
        by_tendon, by_law, plain = damped(forwards[Mode.CONTROL], tendon, pair, refined)
        off.append(np.max(np.abs(by_law - by_tendon)))
    assert off[0] < HELD * np.max(np.abs(by_tendon - plain))
    assert off[1] < 0.6 * off[0]


@pytest.mark.parametrize("mode", [Mode.MOTION, Mode.CONTROL])
def test_a_law_within_a_play_is_friction_behind_a_spring_and_a_gap(
    forwards: dict[Mode, MjcfForward], mode: Mode
) -> None:
    forward, programme = forwards[mode], fed(mode)
    sizes = {"level": LEVEL, "travel": TRAVEL, "gap": GAP}
    values = {f"friction_behind_gap@a:{name}": size for name, size in sizes.items()}
    half, wide = 0.5 * GAP, GAP + 2.0 * TRAVEL
    knots = (-half - TRAVEL, -half, half, half + TRAVEL)
    law = effort("a", f"position@a within {wide}", knots, (LEVEL, 0.0, 0.0, -LEVEL))
    lawful = forward.simulate(programme, {}, False, (law,))
    assert_allclose(lawful, forward.simulate(programme, values), atol=1e-9)
    assert np.max(np.abs(lawful - forward.simulate(programme, {}))) > 0.1


def test_where_a_joint_stands_in_a_play_is_the_strain_of_its_slider() -> None:
    path = np.sin(np.linspace(0.0, 9.0, 200))
    place = variable_along("position@a within 0.4", {"position@a": path})
    friction = FrictionBehindGap("a", 1.0, 0.0, 0.2, 0.0)
    assert_allclose(friction.hold(path), place / 0.2, atol=1e-12)


def test_a_stop_holds_a_joint_whose_motion_is_fed_in(forwards: dict[Mode, MjcfForward]) -> None:
    forward, programme = forwards[Mode.MOTION], fed(Mode.MOTION)
    values = (0.1, 1.0, 30.0, 0.5, 0.3)
    stop = Law("a", LawKind.EFFORT, LawShape.STOP, ("position@a",), (), values)
    change = (forward.simulate(programme, {}, False, (stop,)) - forward.simulate(programme, {}))[
        :, 0
    ]
    path = forward.visited(programme, {})
    deep = path["position@a"] - 0.1
    push = np.maximum(30.0 * deep + 0.5 * path["speed@a"], 0.0)
    assert_allclose(change, np.where(deep > 0.0, push, 0.0), atol=1e-9)
    assert np.max(change) > 1.0


def test_places_where_motion_is_fed_in_have_pairs_of_joints_and_plays(
    forwards: dict[Mode, MjcfForward],
) -> None:
    moved, driven = ({p.name: p for p in forwards[m].law_places()} for m in forwards)
    assert {"a", "b", "a + b", "a - b"} <= moved.keys()
    assert [v.name for v in moved["a - b"].variables] == ["position@a - b", "speed@a - b"]
    assert any(v.name == "position@a within 0.64" for v in moved["a"].variables)
    assert "a + b" not in driven


def test_a_file_with_such_laws_loads_and_unknown_parts_are_told(tmp_path: Path) -> None:
    table = (
        '[[laws]]\nplace = "{}"\nkind = "effort"\nof = ["{}"]\nknots = [[0, 1]]\nvalues = [0, 1]'
    )
    rig = arm(tmp_path, {}, table.format("a + b", "position@b within 0.1"))
    assert rig.laws[0].place == "a + b"
    with pytest.raises(UnknownNameError, match="c"):
        arm(tmp_path, {}, table.format("a + c", "speed@a"))
    with pytest.raises(UnknownNameError, match="speed@c"):
        arm(tmp_path, {}, table.format("a", "speed@a - c"))
    with pytest.raises(VesTwinError, match="width of a play"):
        arm(tmp_path, {}, table.format("a", "position@a within wide"))
