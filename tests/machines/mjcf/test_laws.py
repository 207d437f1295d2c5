"""Laws in MJCF machines: as the model's own physics where that has them, in file and in fault."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import two_link
from numpy.testing import assert_allclose
from pendulum import DAMPING, FED, MACHINE, SDS

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.settings import Settings
from ves_twin.diagnosis.verdict.verdict import Kind
from ves_twin.effects.law import Law, LawKind, LawShape
from ves_twin.effects.law_table import LawTable
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.inputs.programmes import multisine
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.work import Work, measured_variables
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.extend import write_rig
from ves_twin.machines.mjcf.rig.machine import Rig

FORWARD = MjcfForward.of(MACHINE)
SPAN = (-20.0, 20.0)

EXPLICIT = 0.02
"""Share of a damping's own change that its effort makes when it is held over a step of 1 ms."""

HELD = 0.01
"""rad, rad/s: what an effort that is held over a step of 2 ms may be off, of speeds of 6 rad/s;
MuJoCo takes its own damping implicitly."""


def effort(of: str, low: float, high: float, span=SPAN, place="joint") -> Law:
    return Law(place, LawKind.EFFORT, LawShape.TABLE, (of,), (span,), (low, high))


def test_a_law_proportional_to_speed_is_damping() -> None:
    more = FORWARD.simulate(FED, {DAMPING: 0.06})
    law = effort("speed@joint", 0.2, -0.2)  # -0.01 N m s/rad
    off = FORWARD.simulate(FED, {}, False, (law,)) - more
    finer = FORWARD.simulate(FED, {}, True, (law,)) - FORWARD.simulate(FED, {DAMPING: 0.06}, True)
    assert np.max(np.abs(off)) < HELD
    assert np.max(np.abs(finer)) < 0.6 * np.max(np.abs(off))
    assert np.max(np.abs(more - FORWARD.simulate(FED, {}))) > 10 * HELD


def test_a_law_proportional_to_position_is_a_spring() -> None:
    stiff = FORWARD.simulate(FED, {"joint_spring@joint:stiffness": 0.1})
    law = effort("position@joint", 2.0, -2.0)
    assert_allclose(FORWARD.simulate(FED, {}, False, (law,)), stiff, atol=HELD)


def test_a_law_of_the_command_is_a_gain() -> None:
    strong = FORWARD.simulate(FED, {"actuator_gain@drive:gain": 1.1})
    law = effort("command@drive", -2.0, 2.0)
    assert_allclose(FORWARD.simulate(FED, {}, False, (law,)), strong, atol=1e-9)


def test_a_command_that_a_recording_does_not_have_is_none() -> None:
    """Columns are held against a machine with such a law by inverse dynamics, without commands."""
    work = Work.begin(MACHINE, replace(FED, drive={}), {}, (effort("command@drive", -2.0, 2.0),))
    along = measured_variables(work, np.ones((len(FED.time), 2)))
    assert not np.any(along["command@drive"])
    assert not np.any(work.lawful("joint", along))


def test_a_mesh_that_depends_on_speed_alone_is_the_table() -> None:
    table = effort("speed@joint", 0.4, -0.4)
    knots, of = ((-4.0, 0.0, 4.0), SPAN), ("position@joint", "speed@joint")
    mesh = Law("joint", LawKind.EFFORT, LawShape.MESH, of, knots, (0.4, -0.4) * 3)
    runs = [FORWARD.simulate(FED, {}, False, (law,)) for law in (table, mesh)]
    assert_allclose(*runs, atol=1e-9)


def test_a_stop_keeps_the_joint_on_one_side() -> None:
    free = FORWARD.simulate(FED, {})[:, 0]
    values = (-0.2, -1.0, 500.0, 2.0, 0.0)
    stop = Law("joint", LawKind.EFFORT, LawShape.STOP, ("position@joint",), (), values)
    held = FORWARD.simulate(FED, {}, False, (stop,))[:, 0]
    assert free.min() < -0.5
    assert held.min() > -0.25


def test_a_law_of_a_reading_moves_its_column_alone() -> None:
    law = Law("joint.rate", LawKind.READING, LawShape.TABLE, ("speed@joint",), (SPAN,), (-0.4, 0.4))
    plain, read = FORWARD.simulate(FED, {}), FORWARD.simulate(FED, {}, False, (law,))
    assert np.array_equal(plain[:, 0], read[:, 0])
    assert_allclose(read[:, 1], 1.02 * plain[:, 1], atol=1e-9)


def test_laws_act_beside_effects_that_are_stepped_row_by_row() -> None:
    """Backlash, say, takes the loop in Python, and a law is the same there."""
    told = MACHINE.description
    changes = {"present": {"quadratic_drag": {"joint": {"drag": 0.02}}}}
    dragged = MjcfForward(
        replace(MACHINE, description=told.model_copy(update=changes)), Mode.CONTROL
    )
    x = np.linspace(-12.0, 12.0, 2001)
    knots, values = (tuple(x.tolist()),), tuple((-0.02 * np.abs(x) * x).tolist())
    law = Law("joint", LawKind.EFFORT, LawShape.TABLE, ("speed@joint",), knots, values)
    spring = effort("position@joint", 2.0, -2.0)
    stepped = dragged.simulate(FED, {}, False, (spring,))
    compiled = FORWARD.simulate(FED, {}, False, (spring, law))
    assert_allclose(stepped, compiled, atol=1e-4)


def test_a_file_with_a_law_loads_and_runs_as_it_was_written(tmp_path: Path) -> None:
    law = LawTable(
        place="joint",
        kind=LawKind.EFFORT,
        of=("speed@joint",),
        knots=((-8.0, 0.0, 8.0),),
        values=(0.3, 0.0, -0.3),
        form="-0.04 x",
        seen=((-5.0, 5.0),),
    )
    told = MACHINE.description.model_copy(update={"laws": (law,)})
    rig = replace(MACHINE, description=told)
    path = tmp_path / "plant.toml"
    write_rig(rig, path)
    again = Rig.load(str(path))
    assert again.description.laws == (law,)
    runs = [MjcfForward.of(one).simulate(FED, {}) for one in (rig, again)]
    assert np.array_equal(*runs)
    assert not np.allclose(runs[0], FORWARD.simulate(FED, {}))


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        ({"place": "joind"}, UnknownNameError, "joint"),
        ({"of": ("sped@joint",)}, UnknownNameError, "speed@joint"),
        ({"knots": ((1.0, 0.0),)}, InvalidInputError, "rising"),
        ({"values": (1.0,)}, InvalidInputError, "expected 2"),
        ({"shape": "stop"}, InvalidInputError, "stop"),
    ],
)
def test_a_law_that_fits_no_machine_is_refused_in_one_line(
    tmp_path: Path, change: dict[str, object], error: type[Exception], said: str
) -> None:
    entry = {
        "place": "joint",
        "kind": "effort",
        "of": ("speed@joint",),
        "knots": ((-1.0, 1.0),),
        "values": (0.1, -0.1),
        **change,
    }
    lines = "\n".join(f"{key} = {_toml(value)}" for key, value in entry.items())
    path = tmp_path / "odd.toml"
    path.write_text(f'schema = 1\nkind = "rig"\nbase = "pendulum"\n\n[[laws]]\n{lines}\n')
    with pytest.raises(error, match=said) as caught:
        Rig.load(str(path))
    assert "\n" not in str(caught.value)


def _toml(value: object) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return f'"{value}"' if isinstance(value, str) else str(value)


@pytest.mark.parametrize("mode", list(Mode))
def test_a_law_is_the_same_damping_however_a_machine_is_fed(tmp_path: Path, mode: Mode) -> None:
    forward = MjcfForward.of(two_link.rig(tmp_path), mode)
    law = Law(
        "rail", LawKind.EFFORT, LawShape.TABLE, ("speed@rail",), ((-9.0, 9.0),), (18.0, -18.0)
    )
    fed = two_link.programme()
    plain = forward.simulate(fed, {})
    damped = forward.simulate(fed, {"viscous_friction@rail:damping": 6.0})
    change = np.max(np.abs(damped - plain), axis=0)
    off = np.max(np.abs(forward.simulate(fed, {}, False, (law,)) - damped), axis=0)
    moved = change > 1e-9
    assert moved.any()
    assert np.all(off[moved] < EXPLICIT * change[moved])


def test_a_law_of_another_joints_motion_needs_the_effort_back_that_it_gave(tmp_path: Path) -> None:
    """Forward with the law, then inverse dynamics of that motion with it: what was asked for."""
    machine, fed = two_link.rig(tmp_path), two_link.programme()
    of, span = ("position@swing",), (-2.0, 2.0)
    law = Law("rail", LawKind.EFFORT, LawShape.TABLE, of, (span,), (-12.0, 12.0))
    forward = MjcfForward.of(machine, Mode.CONTROL)
    rows = forward.simulate(fed, {}, False, (law,))
    names = [channel.name for channel in forward.channels]
    moved = {n: rows[:, [names.index(n)]] for n in ("cart.position", "arm.angle")}
    back = Excitation("back", fed.time, {**fed.drive, **moved})
    inner, gaps = slice(200, -200), []
    for laws in ((law,), ()):
        needed = MjcfForward.of(machine, Mode.MOTION).simulate(back, {}, False, laws)[:, 0]
        asked = np.interp(fed.time - 0.001, fed.time, fed.drive["drive.force"][:, 0])
        speed = np.gradient(moved["cart.position"][:, 0], fed.time)
        sliding = np.abs(speed[inner]) > 0.05
        gaps.append(float(np.sqrt(np.mean((needed - asked)[inner][sliding] ** 2))))
    assert gaps[0] < 0.3  # friction's solver is soft: 2 % of the 15 N that act
    assert gaps[1] > 5.0 * gaps[0]


def promoted() -> Rig:
    """The pendulum whose library has drag in the square of speed, by a file and no code."""
    x = np.linspace(-12.0, 12.0, 201)
    drag = LawTable(
        place="joint",
        kind=LawKind.EFFORT,
        of=("speed@joint",),
        knots=(tuple(x.tolist()),),
        values=tuple((-0.01 * np.abs(x) * x).tolist()),
        cause=True,
    )
    told = MACHINE.description.model_copy(update={"laws": (drag,)})
    return replace(MACHINE, description=told)


def test_a_law_that_is_a_cause_is_not_at_work_until_its_factor_is() -> None:
    forward = MjcfForward.of(promoted())
    (name,) = (p.name for p in forward.parameters if p.name.startswith("law@"))
    assert np.array_equal(forward.simulate(FED, {}), FORWARD.simulate(FED, {}))
    law = promoted().promoted[0].scaled(0.5).law
    half = forward.simulate(FED, {name: 0.5})
    assert np.array_equal(half, FORWARD.simulate(FED, {}, False, (law,)))
    assert [h.label for h in forward.hypotheses if h.effect == "law"] == ["law@joint(speed@joint)"]


@pytest.mark.slow
def test_a_law_that_was_promoted_is_named_by_the_next_diagnosis(tmp_path: Path) -> None:
    machine = MjcfMachine(promoted())
    name = promoted().promoted[0].name
    records = []
    for seed in (1, 2):
        fed = multisine(MACHINE, np.random.default_rng(seed), 4.0)
        rows = machine.forward.simulate(fed, {name: 0.6})
        rows = rows + np.random.default_rng(seed).standard_normal(rows.shape) * SDS
        signals = {"joint.angle": rows[:, :1], "joint.rate": rows[:, 1:], **fed.drive}
        records.append(Recording(fed.time, signals, RecordingInfo("measured", scenario="run")))
    settings = Settings(nulls=30, cache=tmp_path)
    found = diagnose(records[:1], machine, held_out=records[1:], settings=settings)
    assert found.verdict.verdict is Kind.NAMED
    (cause,) = found.verdict.causes
    assert (cause.effect, cause.target) == ("law", "joint(speed@joint)")
    (factor,) = cause.parameters.values()
    assert factor.value == pytest.approx(0.6, abs=2.0 * (factor.high - factor.low))
    assert isinstance(found.extended, MjcfMachine)
    (law,) = found.extended.rig.laws
    assert law.at(np.array([5.0]))[0] == pytest.approx(-0.01 * factor.value * 25.0, rel=1e-3)
