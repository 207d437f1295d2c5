"""A machine's file that cannot be right is told before any fit; a fault is none of that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from two_link import TIME, programme, rig, write_files

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.machines.diagnose import diagnose
from ves_twin.machines.mjcf.mjcf_machine import MjcfMachine
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.plausible.implausible import implausible
from ves_twin.machines.mjcf.plausible.reading import Reading
from ves_twin.machines.mjcf.plausible.seen import Seen
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.transmission import told_by_motion


@pytest.fixture(scope="module")
def machine(tmp_path_factory) -> Rig:
    return rig(tmp_path_factory.mktemp("rig"), "motion")


def recorded(machine: Rig, **values: float) -> Recording:
    """Efforts along a motion, as a machine with other values records them."""
    fed = programme()
    forward = MjcfForward.of(machine, Mode.MOTION)
    rows = forward.simulate(fed, values)
    names = [c.name for c in forward.channels]
    efforts = {n: rows[:, [names.index(n)]] for n in ("drive.force", "hinge.torque")}
    info = RecordingInfo("measured", scenario="run")
    return Recording(TIME, {**fed.drive, **efforts}, info)


def scaled(recording: Recording, **factors: float) -> Recording:
    signals = dict(recording.signals)
    for name, factor in factors.items():
        signals[name] = factor * signals[name]
    return replace(recording, signals=signals)


def swapped(recording: Recording, one: str, two: str) -> Recording:
    signals = dict(recording.signals)
    signals[one], signals[two] = signals[two], signals[one]
    return replace(recording, signals=signals)


def test_a_machine_that_is_described_as_it_is_passes(machine):
    assert implausible(machine, recorded(machine)) is None


@pytest.mark.parametrize("level", [0.0, 3.0])
def test_an_effort_that_never_changes_tells_nothing(machine, level):
    """Of an excavator at rest, its valve at zero, the duty was to be taken 3.7e18 times."""
    still = recorded(machine)
    force = np.full_like(still["drive.force"], level)
    still = replace(still, signals={**still.signals, "drive.force": force})
    seen = Seen.of(machine, still)
    assert seen is not None
    left = dict(zip(seen.names, seen.left(Reading("", "", {}, {})), strict=True))
    assert left["drive.force"] == 0.0
    assert 0.0 < left["hinge.torque"] < 0.1
    assert implausible(machine, still) is None


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ({"drive.force": -1.0}, "other sign of drive.force"),
        ({"cart.position": -1.0}, "other sign of cart.position"),
        ({"hinge.torque": -1.0}, "other sign of hinge.torque"),
        ({"arm.angle": 57.29578}, "arm.angle in degrees"),
        ({"cart.position": 1e3}, "cart.position in mm"),
        ({"hinge.torque": 1e3}, "hinge.torque in N mm"),
        ({"drive.force": -1.0, "hinge.torque": -1.0}, "other sign of all efforts"),
    ],
)
def test_a_column_with_another_sign_or_unit_is_named(machine, factors, words):
    found = implausible(machine, scaled(recorded(machine), **factors))
    assert found is not None
    assert words in found.came
    of_unit = any(abs(factor) != 1.0 for factor in factors.values())
    assert ("masses of the model" in found.expected) is of_unit  # which may be as far off
    assert "check" in str(found.error)


def test_swapped_columns_and_turned_gravity_are_named(machine):
    found = implausible(machine, swapped(recorded(machine), "drive.force", "hinge.torque"))
    assert found is not None
    assert "drive.force and hinge.torque swapped" in found.came
    other = replace(machine)
    other.model.opt.gravity[:] *= -1.0
    found = implausible(other, recorded(machine))
    assert found is not None
    assert "gravity the other way" in found.came


def test_no_cause_of_the_library_at_its_largest_passes_for_a_wrong_file(machine):
    for cause in machine.hypotheses:
        sizes = np.max(np.abs(cause.departures()), axis=0)
        nominal = {p.name: p for p in machine.parameters}
        for sign in cause.signs:
            values = {
                name: float(np.clip(nominal[name].nominal + sign * size, *_bounds(nominal[name])))
                for name, size in zip(cause.parameters, sizes, strict=True)
            }
            assert implausible(machine, recorded(machine, **values)) is None, cause.label


def _bounds(parameter) -> tuple[float, float]:
    return parameter.low, parameter.high


def test_a_diagnosis_ends_before_any_fit_with_the_key_to_look_at(tmp_path):
    machine = MjcfMachine(Rig.load(str(write_files(tmp_path, "motion"))))
    wrong = scaled(recorded(machine.rig), **{"drive.force": -1.0})
    with pytest.raises(InvalidInputError, match=r"other sign of drive.force.*sign"):
        diagnose([wrong], machine.rig)


def test_nothing_is_said_where_a_position_is_missing(machine):
    less = recorded(machine)
    signals = {n: v for n, v in less.signals.items() if n != "arm.angle"}
    assert implausible(machine, Recording(less.time, signals, less.info)) is None


def test_open_loop_recordings_are_judged_the_same_way(tmp_path):
    """Commands fed in, positions measured: still inverse dynamics, whatever a simulation does."""
    machine = rig(tmp_path, "control")
    fed = programme()
    forward = MjcfForward.of(machine)
    rows = forward.simulate(Excitation("run", TIME, fed.drive), {})
    names = [c.name for c in forward.channels]
    moved = {n: rows[:, [names.index(n)]] for n in ("cart.position", "arm.angle")}
    record = Recording(TIME, {**fed.drive, **moved}, RecordingInfo("measured", scenario="run"))
    assert implausible(machine, record) is None
    found = implausible(machine, scaled(record, **{"drive.force": -1.0}))
    assert found is not None
    assert "other sign of drive.force" in found.came


VALVE = """<mujoco>
  <worldbody><body><joint name="rod" type="slide" damping="100"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
  <actuator><motor name="valve" joint="rod"/></actuator>
</mujoco>"""

BEFORE_IT = """schema = 1
kind = "rig"
name = "valve"
model = "valve.xml"
clock = { column = "t" }
drive = { mode = "control", smoothing = 10 }
[signals]
u = { columns = ["u"], unit = "N", actuator = "valve" }
x = { columns = ["x"], unit = "m", joint = "rod", noise = 1e-5 }
"""


def test_a_model_with_too_much_friction_of_its_own_is_no_wrong_unit(tmp_path):
    """It would be hidden by any unit that makes efforts large, or motion small."""
    (tmp_path / "valve.xml").write_text(VALVE)
    (tmp_path / "valve.toml").write_text(BEFORE_IT)
    machine = Rig.load(str(tmp_path / "valve.toml"))
    effort = np.sin(3.0 * TIME)
    place = -np.cos(3.0 * TIME) / 3.0 / 40.0  # damping of 40 N s/m where the model has 100
    recording = Recording(
        TIME, {"u": effort[:, None], "x": place[:, None]}, RecordingInfo("measured")
    )
    assert implausible(machine, recording) is None
    found = implausible(machine, scaled(recording, u=-1.0))
    assert found is not None
    assert "other sign" in found.came


def test_efforts_by_a_factor_that_no_unit_has_are_told_with_it(machine):
    found = implausible(machine, scaled(recorded(machine), **{"hinge.torque": 400.0}))
    assert found is not None
    assert "hinge.torque times 0.00" in found.came
    assert "gears of the model" in found.expected


def test_an_inertia_that_the_model_lacks_is_no_other_unit(machine):
    """A geared joint whose model has no armature: its motor's inertia is a hundred times its own."""
    assert implausible(machine, scaled(recorded(machine), **{"drive.force": 400.0})) is None


def test_a_usual_unit_is_told_without_the_factor(machine):
    found = implausible(machine, scaled(recorded(machine), **{"hinge.torque": 1e3}))
    assert found is not None
    assert "N mm" in found.came
    assert "times" not in found.came


def test_of_two_motors_at_one_joint_a_motion_tells_none(tmp_path):
    """Where commands are fed in that is no reason to refuse a recording."""
    one = rig(tmp_path)
    path = tmp_path / "two_link.xml"
    second = '<motor name="drive" joint="rail"/>'
    path.write_text(path.read_text().replace(second, f'{second}<motor name="help" joint="rail"/>'))
    told = Rig(one.description, tmp_path)
    assert told_by_motion(told.model, ["drive", "hinge"]) == ["drive", "hinge"]
    assert told_by_motion(told.model, ["drive", "help", "hinge"]) == ["hinge"]
