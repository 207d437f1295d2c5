"""AdmittanceTuning: tune the leg loops of an emulation on a rig with hidden faults of valves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, final

import numpy as np

from ves_twin.control.leg_loop import FilterPlace
from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.envs.arm_env import JOINT_UNITS, WRENCH_UNITS, time_left
from ves_twin.envs.channels import Channel, Channels
from ves_twin.envs.leg_channels import distance, leg_channels, leg_readings
from ves_twin.envs.rig_env import CYCLES, RigEnv
from ves_twin.envs.tuned_legs import RATE_GAIN, TunedLegs
from ves_twin.plant.plant import Plant
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.arm_commands import arm_motion
from ves_twin.simulator.build import build_references
from ves_twin.simulator.recorder import IDEAL, NoSink
from ves_twin.simulator.signal_bus import SignalBus
from ves_twin.simulator.simulator import Simulator

SHAKING = 10.0
"""Loss of a force above 5 Hz at its limit, as an emulation error [mm]: what lags and shakes no
more than the limit loses about as much by either."""


@final
class AdmittanceTuning(RigEnv[TunedLegs]):
    """Loss per second: emulation error in mm + 10 mm (shaking over its limit)^2.

    The emulation error is the distance of the true pose from the zero-g motion of the same arm on
    the emulated base; shaking is the cost `stability`. The arm moves by the scenario's programme.
    Actions are octaves of the leg gain and of the filter's edge, and the gain of the speed term;
    zero is the scenario's own tuning. Faults of valves are drawn for each episode.
    """

    SCENARIO: ClassVar[str] = "admittance_tuning"
    WORST: ClassVar[float] = 100.0
    HIDDEN: ClassVar[str] = "valves-v0"

    def check(self, scenario: Scenario) -> None:
        """A zero-g reference to compare with, and a filter to tune.

        Raises:
            InvalidInputError: a scenario without.
        """
        if not scenario.has_reference or scenario.legs.filter is FilterPlace.NONE:
            what = f"mode '{scenario.platform.mode}', filter '{scenario.legs.filter.value}'"
            expected = "mode 'micro_gravity' and a filter in legs.filter"
            raise InvalidInputError(f"scenario {scenario.name}", what, expected)

    def channels(self, scenario: Scenario) -> tuple[Channels, Channels]:
        """Legs, payload, arm, the tuning in force."""
        wrench = Plant.load(scenario.belief).parameters.array("sensor.range")
        tuning = (
            Channel.within("legs.gain", ("octave",), 1.0, "of the scenario's leg gain"),
            Channel.within("legs.edge", ("octave",), 1.0, "of the scenario's filter edge"),
            Channel.within("legs.rate_gain", ("1",), RATE_GAIN, "added; none below zero"),
        )
        observed = Channels(
            *leg_channels(scenario),
            Channel.within(
                "gravity.estimate", WRENCH_UNITS, wrench, "gravity part as the computers think"
            ),
            Channel.within("arm.q", JOINT_UNITS, np.pi, "joint angles by the encoders"),
            *tuning,
            time_left(scenario),
        )
        return observed, Channels(*tuning)

    def build(self, plant: Plant, scenario: Scenario) -> tuple[Simulator, TunedLegs]:
        """A simulator whose leg loops the environment tunes."""
        sim = Simulator(plant, scenario, sink=NoSink())
        return sim, TunedLegs.of(sim, _zero_gravity_poses(sim))

    def start(self, goal: object) -> None:
        """Begin with the scenario's tuning."""
        self.hand.hold()
        self._away, self._square, self._peak, self._shaken, self._cycles = 0.0, 0.0, 0.0, 0.0, 0

    def command(self, action: FloatArray, span: float) -> None:
        """Octaves of gain and edge, gain of the speed term (3,)."""
        self.hand.command(action, span)

    def loss(self, poses: FloatArray, arm_q: FloatArray, times: Sequence[float]) -> float:
        """Emulation errors [mm] and shaking."""
        first = self._cycles + 1
        rows = self.hand.reference[first : first + len(poses)]
        away = [distance(pose, row) for pose, row in zip(poses, rows, strict=True)]
        self._cycles += len(away)
        self._away = away[-1]
        self._square += sum(error**2 for error in away)
        self._peak = max(self._peak, *away)
        shaking = float(self._costs.used[2])
        self._shaken = max(self._shaken, shaking)
        return sum(away) + SHAKING * shaking**2 * len(away)

    def readings(self, board: SignalBus) -> dict[str, FloatArray]:
        """Measurements and the tuning in force."""
        octaves = self.hand.at
        return {
            **leg_readings(board, self.measured_pose, self._costs.home_lengths),
            "gravity.estimate": board["gravity.estimate"],
            "arm.q": board["arm.q"],
            "legs.gain": octaves[:1],
            "legs.edge": octaves[1:2],
            "legs.rate_gain": octaves[2:],
            "time.left": np.array([self.left]),
        }

    def truth(self) -> dict[str, FloatArray | float]:
        """Emulation error [mm]."""
        return {"emulation_error": self._away}

    def metrics(self) -> dict[str, float]:
        """Rms and peak of the emulation error [mm], largest share of the shaking's limit."""
        rms = float(np.sqrt(self._square / max(self._cycles, 1)))
        return {"emulation_rms": rms, "emulation_peak": self._peak, "shaking": self._shaken}


def _zero_gravity_poses(sim: Simulator) -> FloatArray:
    """The ideal reference at every cycle to the end of the run (k, 6), as a recording has it."""
    servo = sim.rig.parameters["servo"]
    reference = build_references(sim.scenario, sim.plant, servo)[IDEAL]
    clock, arm = sim.rig.clock, arm_motion(sim.scenario)
    cycle = clock.admittance * clock.tick
    count = round(sim.scenario.run.duration / cycle) + CYCLES + 1
    times = cycle * np.arange(count - 1)
    points = [[arm.q(time + i * cycle) for i in (-1, 0, 1, 2)] for time in times]
    poses, _, _ = reference.advance(np.array(points), cycle)
    return poses
