"""Sensors that an MJCF machine could have: what they read, and that its own stay as they are."""

import numpy as np
import pytest
from two_link import write_files

from ves_twin.cli.main import main
from ves_twin.machines.machine import Machine
from ves_twin.machines.mjcf.inputs.further import PREFIX, with_further


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return Machine.load(str(write_files(tmp_path_factory.mktemp("two_link"))))


def test_the_machine_s_own_channels_come_first_and_read_as_before(machine):
    forward, more = machine.forward, machine.further()
    fed = machine.excitations()[0]
    own = len(forward.channels)
    assert more.channels[:own] == forward.channels
    assert all(channel.name.startswith(PREFIX) for channel in more.channels[own:])
    assert more.identity != forward.identity
    rows = more.simulate(fed, {})
    assert rows[:, :own] == pytest.approx(forward.simulate(fed, {}), abs=1e-12)


def test_a_further_encoder_reads_the_joint_and_an_effort_what_the_motor_gives():
    machine = Machine.load("pendulum")
    more = with_further(machine.forward)
    names = [channel.name for channel in more.channels]
    assert names[2:] == [f"{PREFIX}{of} of joint" for of in ("position", "speed", "effort")]
    fed = machine.excitations()[0]
    late = {"sensor_delay@joint:delay": 0.01, "actuator_gain@drive:gain": 1.2}
    rows = more.simulate(fed, late)
    steps = round(0.01 / fed.period)
    # the machine's own angle is late by the computer that reads it; a further one is not
    assert rows[steps:, 0] == pytest.approx(rows[:-steps, 2], abs=2e-5)
    command = fed.drive["joint.torque"][:, 0]
    assert rows[1:-1, 4] == pytest.approx(1.2 * command[1:-1], abs=0.02)


def test_a_site_can_have_a_force_sensor_and_an_accelerometer(machine):
    more = machine.further()
    widths = {name: len(more.rig.description.signals[name].columns) for name in more.compared}
    assert widths[f"{PREFIX}force at tip"] == widths[f"{PREFIX}acceleration of tip"] == 3
    rows = more.simulate(machine.excitations()[0], {})
    assert np.isfinite(rows).all()
    names = [channel.name for channel in more.channels]
    at = names.index(f"{PREFIX}acceleration of tip.1")
    # at rest an accelerometer reads gravity
    assert np.linalg.norm(rows[0, at : at + 3]) == pytest.approx(9.81, rel=0.3)


def test_the_command_ranks_them(capsys):
    assert main(["plan", "--plant", "pendulum", "--add-channel"]) == 0
    said = capsys.readouterr().out
    assert "actuator delay at drive / sensor delay at joint" in said
    table = said.splitlines()[-3:]
    assert {line.split("  ")[1] for line in table} == {
        f"{PREFIX}{of} of joint" for of in ("position", "speed", "effort")
    }
    assert all(line.split()[-2] == "1" for line in table)  # the delays are told apart


@pytest.mark.parametrize("options", [["--design", "a/b"], ["--seconds", "3"], ["--out", "x"]])
def test_options_that_say_nothing_here_are_refused(capsys, options):
    assert main(["plan", "--plant", "pendulum", "--add-channel", *options]) == 2
    assert "--add-channel without it" in capsys.readouterr().err.splitlines()[-1]
