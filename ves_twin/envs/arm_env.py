"""ArmEnv: what the two tasks of the arm on an emulated beam share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ves_twin.core.compiled import compiled
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.channels import Channel, Channels
from ves_twin.envs.commanded_arm import CommandedArm
from ves_twin.envs.priors import arm_prior
from ves_twin.envs.rig_env import CYCLES, RigEnv
from ves_twin.envs.true_state import true_state
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.recorder import NoSink
from ves_twin.simulator.signal_bus import SignalBus
from ves_twin.simulator.simulator import Simulator

if TYPE_CHECKING:
    from control import StateSpace

RATE = 0.8
"""Joint rate of a share of 1 [rad/s]; the sweep of coupling_map_paths peaks at 0.6."""

ACCELERATION = 8.0
"""Fastest change of a rate [rad/s^2]: 10 deg at 1 Hz need 7; jumps of an action would otherwise
shake the arm out of the force sensor's range."""

LOW, HIGH = np.radians([-90.0, -15.0, -60.0]), np.radians([120.0, 105.0, 60.0])
"""Joint angles that set-points are held within [rad]; the bounds of coupling_map_paths, widened."""

POSE_UNITS = ("m", "m", "m", "rad", "rad", "rad")
WRENCH_UNITS = ("N", "N", "N", "N*m", "N*m", "N*m")
JOINT_UNITS = ("rad", "rad", "rad")

POSE_LIMIT = np.array([0.5, 0.5, 0.5, 0.8, 0.8, 0.8])
"""Beyond what the legs' travel of 0.25 m allows [m, rad]."""


class ArmEnv(RigEnv[CommandedArm]):
    """The arm's joint rates are commanded; the platform emulates a flexible base beneath it."""

    def check(self, scenario: Scenario) -> None:
        """Something must be emulated, and the arm must not move by itself.

        Raises:
            InvalidInputError: a scenario that does otherwise.
        """
        arm = scenario.arm
        if scenario.platform.emulated is None:
            what = f"{scenario.platform.mode} mode without platform.emulated"
            raise InvalidInputError(f"scenario {scenario.name}", what, "an emulated base")
        if arm.moves or arm.path is not None or arm.operator is not None:
            raise InvalidInputError(
                f"scenario {scenario.name}", "an arm that moves by itself", "arm.start alone"
            )

    def arm_channels(self, scenario: Scenario) -> tuple[tuple[Channel, ...], Channels]:
        """Channels that both tasks observe, and the table of actions."""
        array = Plant.load(scenario.belief).parameters.array
        wrench = array("sensor.range")
        observed = (
            Channel.within(
                "platform.pose", POSE_UNITS, POSE_LIMIT, "pose from home by the leg lengths"
            ),
            Channel.within(
                "sensor.wrench", WRENCH_UNITS, wrench, "payload on platform, sensor axes"
            ),
            Channel.within(
                "gravity.estimate", WRENCH_UNITS, wrench, "its gravity part as the computers think"
            ),
            Channel.within("arm.q", JOINT_UNITS, np.pi, "joint angles by the encoders"),
            Channel.within(
                "arm.torque", ("N*m",) * 3, array("arm.torque_limit") * 1.2, "torque of the drives"
            ),
            Channel.within("arm.command", JOINT_UNITS, np.pi, "set-points of the joint servo"),
        )
        actions = Channels(
            Channel.within("arm.rate", ("rad/s",) * 3, RATE, "rate of the set-points to reach")
        )
        return observed, actions

    def build(self, plant: Plant, scenario: Scenario) -> tuple[Simulator, CommandedArm]:
        """A simulator whose arm follows the environment."""
        hand = CommandedArm(np.array(scenario.arm.start), LOW, HIGH, ACCELERATION)
        return Simulator(plant, scenario, sink=NoSink(), arm=hand), hand

    def start(self, goal: Any) -> None:
        """Forget the commands of the episode before."""
        emulated = self.sim.scenario.platform.emulated
        self._stiffness = EmulatedSystem.load(str(emulated)).stiffness
        self._home = np.array(self.sim.scenario.platform.home)
        self._integral, self._peak, self._energy = 0.0, 0.0, 0.0
        self.hand.hold()
        self._energy = self._energies(true_state(self.sim.rig)[0][None])[0]

    def command(self, action: FloatArray, span: float) -> None:
        """Joint rates [rad/s] (3,) to reach at the end of the step."""
        cycle = span / CYCLES
        self.hand.command(action, self.sim.time + cycle, span)

    def strain(self, poses: FloatArray) -> float:
        """Sum of the strain energies [J] in the emulated base at true poses (k, 6), accounted."""
        energies = self._energies(poses)
        total = sum(energies)
        self._energy = energies[-1]
        self._integral += total * self._cycle
        self._peak = max(self._peak, *energies)
        return total

    def _energies(self, poses: FloatArray) -> list[float]:
        energies = np.zeros(len(poses))
        strain_energies(poses, self._home, self._stiffness, energies)
        return list(energies.tolist())

    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """Measurements and set-points."""
        names = ("sensor.wrench", "gravity.estimate", "arm.q", "arm.torque", "arm.command")
        return {
            "platform.pose": self.measured_pose,
            **{name: board[name] for name in names},
            "time.left": np.array([self.left]),
        }

    def truth(self) -> dict[str, FloatArray | float]:
        """Strain energy in the base [J]."""
        return {"strain_energy": self._energy}

    def metrics(self) -> dict[str, float]:
        """Integral [J s], peak and last value [J] of the strain energy."""
        return {
            "energy_integral": self._integral,
            "energy_peak": self._peak,
            "energy_last": self._energy,
        }

    def prior(self) -> StateSpace:
        """Base behind the legs' lag and arm behind its servo, linear about the start."""
        return arm_prior(self._scenario, RATE)


@compiled
def strain_energies(
    poses: FloatArray, home: FloatArray, stiffness: FloatArray, energies: FloatArray
) -> None:
    """Add 1/2 Y' K Y [J] (k,) of a base at poses (k, 6) that has no strain at home (6,)."""
    for k in range(len(poses)):
        y = poses[k] - home
        for i in range(6):
            for j in range(6):
                energies[k] += 0.5 * y[i] * stiffness[i, j] * y[j]


def time_left(scenario: Scenario) -> Channel:
    """The channel of the time that is left of an episode."""
    return Channel(
        "time.left", ("s",), np.zeros(1), np.array([scenario.run.duration + 1.0]), "to the end"
    )
