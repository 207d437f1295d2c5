"""What may be designed for an MJCF machine keeps its limits, everywhere in the box."""

from pathlib import Path

import numpy as np
import pytest
from two_link import write_files

from ves_twin.cli.main import main
from ves_twin.core.errors import InvalidInputError
from ves_twin.machines.machine import SETPOINTS, Machine
from ves_twin.machines.mjcf.inputs.design_space import MjcfDesignSpace
from ves_twin.machines.mjcf.inputs.inputs import BORNE, inputs_of, sizes_of, strain
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.started import start_signal
from ves_twin.machines.mjcf.rig.description import Mode


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return Machine.load(str(write_files(tmp_path_factory.mktemp("two_link"))))


@pytest.mark.parametrize("mode", [Mode.CONTROL, Mode.REFERENCE])
def test_every_point_keeps_travel_and_speed(machine, mode):
    forward = MjcfForward.of(machine.rig, mode)
    space = MjcfDesignSpace.of(forward, 2.0)
    rng = np.random.default_rng(3)
    names = [channel.name for channel in forward.channels]
    for _ in range(4):
        one = space.excitation(rng.uniform(-1.0, 1.0, space.size), "any")
        assert one is not None
        rows = forward.simulate(one, {})
        for joint in machine.rig.description.typical.joint:
            path = rows[:, names.index(forward.position_of(joint))]
            _, speed, travel = sizes_of(forward, joint)
            assert np.max(np.abs(path - path[0])) <= BORNE * travel
            assert np.max(np.abs(np.gradient(path, one.time))) <= BORNE * speed


def test_positions_that_are_fed_in_keep_half_the_travel_and_the_speed(machine):
    forward = MjcfForward.of(machine.rig, Mode.MOTION)
    space = MjcfDesignSpace.of(forward, 2.0)
    one = space.excitation(np.random.default_rng(1).uniform(-1.0, 1.0, space.size), "any")
    for fed in inputs_of(forward):
        path = one.drive[fed.signal][:, 0]
        assert np.max(np.abs(path - fed.rest)) <= 0.5 * fed.travel * (1.0 + 1e-9)
        assert np.max(np.abs(np.gradient(path, one.time))) <= fed.speed * (1.0 + 1e-9)


def test_a_command_keeps_the_actuator_s_range_and_a_joint_its_own(tmp_path):
    """Ranges of the model below the typical sizes of the file."""
    rig = Machine.load("pendulum").rig
    model = rig.model
    model.actuator_ctrllimited[0], model.actuator_ctrlrange[0] = 1, (-0.3, 0.2)
    model.jnt_limited[0], model.jnt_range[0] = 1, (-0.4, 0.5)
    forward = MjcfForward.of(rig)
    space = MjcfDesignSpace.of(forward, 2.0)
    rng = np.random.default_rng(0)
    for _ in range(4):
        one = space.excitation(rng.uniform(-1.0, 1.0, space.size), "any")
        torque, angle = one.drive["joint.torque"], forward.simulate(one, {})[:, 0]
        assert -0.3 <= torque.min() < torque.max() <= 0.2
        assert -0.4 <= angle.min() < angle.max() <= 0.5


def test_a_joint_is_let_go_within_its_travel_and_the_name_says_from_where():
    forward = Machine.load("pendulum").forward
    space = MjcfDesignSpace.of(forward, 2.0)
    point = np.zeros(space.size)
    point[-1] = -0.5
    one = space.excitation(point, "designed")
    assert one.drive[start_signal("joint")][0] == pytest.approx([-0.5 * BORNE, 0.0])
    assert one.name == "designed, joint let go from -0.75 rad"
    assert strain(forward, one) <= 1.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--design", "sensor_delay"], "expected A/B, or causes"),
        (["--design", "sensor_delay/actuator_gian"], "did you mean 'actuator_gain'"),
        (["--design", "sensor_delay/actuator_gain", "--seconds", "0.1"], "seconds: got 0.1"),
        (["--design", "sensor_delay/actuator_gain", "--channels", "joint.angel"], "joint.angle"),
        (["--out", "somewhere"], "--design beside it"),
    ],
)
def test_a_design_refuses_bad_input_in_one_line_and_writes_nothing(
    capsys, tmp_path, monkeypatch, options, words
):
    monkeypatch.chdir(tmp_path)
    assert main(["plan", "--plant", "pendulum", *options]) == 2
    assert words in capsys.readouterr().err.strip().splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


def test_two_delays_are_told_apart_in_half_the_time_of_the_menu(tmp_path, capsys, monkeypatch):
    """The menu's best takes 4 s; the file has the columns of the machine's log."""
    monkeypatch.setattr("ves_twin.diagnosis.experiment.design.SCATTERED", 3)
    monkeypatch.setattr("ves_twin.diagnosis.experiment.design.EACH", 2)
    words = ["plan", "--plant", "pendulum", "--seconds", "2", "--out", str(tmp_path)]
    assert main([*words, "--design", "Actuator delay at drive / sensor delay at joint"]) == 0
    said = capsys.readouterr().out
    assert "menu      let go from 0.6 of the travel into a multisine, 4.0 s" in said
    after = float(said.split("as much after ")[1].split(" s")[0])
    assert after <= 2.0
    head, *rows = Path(tmp_path, SETPOINTS).read_text().splitlines()
    assert head == "t_s,torque_Nm"
    assert len(rows) == 1001
    assert max(abs(float(row.split(",")[1])) for row in rows) <= 1.0  # typical effort


def test_a_machine_without_typical_sizes_has_no_design():
    with pytest.raises(InvalidInputError, match="a recording to go by"):
        Machine.load("ft_wrist").design_space(5.0)
