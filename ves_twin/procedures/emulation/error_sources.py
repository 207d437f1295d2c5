"""ErrorSources: runs of one experiment with what spoils the emulation switched on one by one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ves_twin.core.errors import VesTwinError
from ves_twin.core.recording.recording import Recording
from ves_twin.core.types import FloatArray
from ves_twin.plant.fidelity import Fidelity
from ves_twin.plant.plant import Plant
from ves_twin.procedures.procedure import Progress, part_of
from ves_twin.scenario.schema import Scenario
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.simulate import simulate

QUICK: Mapping[str, Any] = {
    "platform.rate": 400.0,
    "gravity.age": 0,
    "parameters.sensor.corner": 80.0,
    "parameters.clock.cycle_time": [0.001, 0.001, 0.001],
}
"""Computers and sensor without delay to speak of: five times the rate, four times the corner."""

SENSOR_NOISE = ("sensor.noise", "sensor.wander")
ORIENTATION = ("platform.level", "transducer.noise", "transducer.resolution")
DRIFT = ("sensor.drift",)
DRAWN = ("sensor.drift", "platform.level")

GRAVITY_SOURCES = ("gravity model", "orientation", "sensor noise", "drift")
"""What the estimate and the reading get wrong; the other sources are the rig's."""

TRUTH: Mapping[str, Any] = {"gravity.method": "truth", "gravity.file": None}
BELIEVED: Mapping[str, Any] = {"gravity.method": "model", "gravity.file": None}

Plans = dict[str, tuple[Plant, Mapping[str, Any]]]
"""Name of a run -> plant, and what is changed in the scenario."""

RIG_SOURCES = ("leg bandwidth", "delay", "structure", "left")


@dataclass(frozen=True)
class ErrorSources:
    """The experiment, the rig with its real sensor, and the same with an ideal one.

    Attributes:
        scenario: name or path of a micro-gravity scenario of the Model Method.
        changes: keys of it that are changed in every run.
        real: the rig, with a sensor whose gains are off and a calibration for it.
        ideal: the same rig with a sensor whose gains are right.
        seed: of the noise and of what is drawn.
    """

    scenario: str
    changes: Mapping[str, Any]
    real: Plant
    ideal: Plant
    seed: int

    def parts(self, progress: Progress) -> dict[str, FloatArray]:
        """Error of the pose over time by source, and with everything on [m, rad] (n, 6).

        The rig's sources are switched off one after the other until the zero-g reference is left:
        structure (`fast` instead of `full`), delay (`QUICK`), leg bandwidth (the reference that
        has it and nothing else); `left` is what remains. The others are switched on alone, on a
        rig with exact gravity, without noise: the calibrated sensor, the orientation off by its
        sd, noise, drift. Keys: `everything`, then the sources.

        Raises:
            VesTwinError: a run that ended early.
        """
        fast = _silent(self.ideal).with_fidelity(Fidelity.FAST)
        runs = self._runs(
            {
                "everything": (self._everything(), {}),
                "fast": (fast, TRUTH),
                "quick": (fast, {**TRUTH, **QUICK}),
                **self._gravity_plans(),
            },
            progress,
        )
        return {**_rig_differences(runs), **_gravity_differences(runs)}

    def gravity_parts(self, progress: Progress) -> dict[str, FloatArray]:
        """Of `parts`, those of GRAVITY_SOURCES [m, rad] (n, 6); the rig's are not run.

        Raises:
            VesTwinError: a run that ended early.
        """
        return _gravity_differences(self._runs(self._gravity_plans(), progress))

    def _gravity_plans(self) -> Plans:
        clean = _silent(self.ideal)
        return {
            "clean": (clean, TRUTH),
            "gravity model": (_silent(self.real), {}),
            "right model": (clean, BELIEVED),
            "orientation": (self._on(ORIENTATION), BELIEVED),
            "sensor noise": (self._on(SENSOR_NOISE), TRUTH),
            "drift": (self._on(DRIFT), TRUTH),
        }

    def _runs(self, plans: Plans, progress: Progress) -> dict[str, Recording]:
        runs: dict[str, Recording] = {}
        for number, (name, (plant, changes)) in enumerate(plans.items()):
            runs[name] = self._run(name, plant, changes)
            part_of(progress, number, len(plans))(1.0, name)
        return runs

    def _run(self, name: str, plant: Plant, changes: Mapping[str, Any]) -> Recording:
        scenario = Scenario.load(self.scenario, {**self.changes, **changes})
        run = simulate(scenario, plant, self.seed)
        if run.info.outcome != Outcome.COMPLETED:
            ended = f"{run.info.outcome} at {run.time[-1]:.3f} s" if len(run) else run.info.outcome
            raise VesTwinError(f"the run with {name} ended early: {ended}")
        return run

    def _drawn(self, name: str) -> FloatArray:
        """A number as it is, or, where commissioning leaves a zero open, one draw of its sd."""
        parameter = self.ideal.parameters[name]
        if name not in DRAWN:
            return parameter.value
        generator = np.random.default_rng([self.seed, DRAWN.index(name)])
        return parameter.value + parameter.sd * generator.normal(size=parameter.value.shape)

    def _on(self, names: tuple[str, ...]) -> Plant:
        return _silent(self.ideal).with_values({name: self._drawn(name) for name in names})

    def _everything(self) -> Plant:
        return self.real.with_values({n: self._drawn(n) for n in (*DRIFT, *ORIENTATION)})


def _silent(plant: Plant) -> Plant:
    """The plant without noise, drift or counts of sensor and transducers."""
    names = (*SENSOR_NOISE, *DRIFT, *ORIENTATION)
    return plant.with_values({name: 0.0 * plant.parameters.array(name) for name in names})


def _rig_differences(runs: dict[str, Recording]) -> dict[str, FloatArray]:
    """Each part as the difference of two runs, or of a run and a reference, at the cycles."""
    clean = runs["clean"]
    time, reference = clean.time, clean["reference.pose"]
    quick = runs["quick"]
    quick_pose = _at(time, quick, "truth.pose")
    quick_legs = _at(time, quick, "reference.pose_leg_lag")
    pose = {name: runs[name]["truth.pose"] for name in ("everything", "clean", "fast")}
    return {
        "everything": pose["everything"] - reference,
        "leg bandwidth": clean["reference.pose_leg_lag"] - reference,
        "delay": pose["fast"] - quick_pose,
        "structure": pose["clean"] - pose["fast"],
        "left": quick_pose - quick_legs,
    }


def _gravity_differences(runs: dict[str, Recording]) -> dict[str, FloatArray]:
    """Each part as the difference of two runs at the cycles."""
    pose = {name: run["truth.pose"] for name, run in runs.items() if name != "quick"}
    return {
        "gravity model": pose["gravity model"] - pose["clean"],
        "orientation": pose["orientation"] - pose["right model"],
        "sensor noise": pose["sensor noise"] - pose["clean"],
        "drift": pose["drift"] - pose["clean"],
    }


def _at(time: FloatArray, run: Recording, name: str) -> FloatArray:
    """A signal at other times, linear between its rows."""
    return np.column_stack([np.interp(time, run.time, column) for column in run[name].T])
