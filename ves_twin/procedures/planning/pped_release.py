"""PpedRelease: a base released from a displaced pose under an arm with several joint gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field, JsonValue

from ves_twin.core.types import ComplexArray, FloatArray
from ves_twin.mechanics.emulated import EmulatedSystem
from ves_twin.mechanics.planning.flexible_base import (
    HIGH_GAINS,
    PPED_GAINS,
    FlexibleBaseArm,
    JointGains,
    strain_energy,
)
from ves_twin.mechanics.planning.pped import (
    Build,
    Measure,
    damping_estimator,
    search_gains,
    strain_energy_integral,
)
from ves_twin.plant.plant import Plant
from ves_twin.plant.puma_chain import puma_chain
from ves_twin.procedures.number_table import write_table
from ves_twin.procedures.procedure import Procedure, Result, RunContext
from ves_twin.scenario.fields import Joints, Pose, Seconds
from ves_twin.simulator.outcome import Outcome
from ves_twin.simulator.zero_gravity import zero_gravity_motion

CYCLE = 1.0 / 80.0
"""Time between two rows [s]. Source: the beam models' rate, thesis App. E."""


@dataclass(frozen=True)
class Release:
    """One set of gains by the linear dynamics with the printed inertias.

    Attributes:
        gains: of the joints.
        poles: of arm and base together [1/s] (18,).
        estimator: thesis eq. 4.4.
        pose: of the base [m, rad] (k, 6).
        energy: strain energy [J] (k,).
        integral: of the energy up to the end, exact [J s].
    """

    gains: JointGains
    poles: ComplexArray
    estimator: float
    pose: FloatArray
    energy: FloatArray
    integral: float


@dataclass(frozen=True)
class NonlinearRelease:
    """The same in the zero-g reference, with the plant's split inertias.

    Attributes:
        energy: strain energy [J] (k,).
        integral: of the energy, by trapezoids [J s].
        integral_linear: what the linear dynamics give with these inertias [J s].
        joint_peak: largest joint excursion [rad] (3,).
    """

    energy: FloatArray
    integral: float
    integral_linear: float
    joint_peak: FloatArray


class PpedRelease(Procedure):
    """Thesis gains, high gains, and gains found here by estimator and by energy.

    `friction` adds the joints' own viscous friction, which the thesis leaves out.
    """

    emulated: str
    q: Joints
    start: Pose
    duration: Annotated[Seconds, Field(gt=0, le=600)]
    friction: bool = False
    smallest_gain: Annotated[float, Field(gt=0)] = 0.1
    largest_gain: Annotated[float, Field(gt=0)] = 1e4

    def builder(self, plant: Plant, printed: bool) -> Build:
        """The arm on its base as a function of the gains; printed or split inertias."""
        base = EmulatedSystem.load(self.emulated)
        arm_mass = puma_chain(plant, printed).mass_matrix(np.array(self.q))
        extra = plant.parameters.array("arm.damping") if self.friction else np.zeros(3)

        def build(gains: JointGains) -> FlexibleBaseArm:
            return FlexibleBaseArm.of(
                arm_mass, base, JointGains(gains.stiffness, gains.damping + extra)
            )

        return build

    def least_energy(self, plant: Plant) -> JointGains:
        """The gains with the smallest energy integral."""
        start = np.array(self.start)
        return self._search(plant, lambda arm: strain_energy_integral(arm, start))

    def best_estimator(self, plant: Plant) -> JointGains:
        """The gains with the largest damping estimator."""
        return self._search(plant, lambda arm: -damping_estimator(arm.poles()))

    def release(self, plant: Plant, gains: JointGains) -> Release:
        """One release by the linear dynamics."""
        arm, start = self.builder(plant, printed=True)(gains), np.array(self.start)
        time = self._times()
        pose = arm.release(start, time)[:, :6]
        poles = arm.poles()
        return Release(
            gains=gains,
            poles=poles,
            estimator=damping_estimator(poles),
            pose=pose,
            energy=strain_energy(EmulatedSystem.load(self.emulated), pose),
            integral=strain_energy_integral(arm, start, float(time[-1])),
        )

    def nonlinear(self, plant: Plant, gains: JointGains) -> NonlinearRelease:
        """One release in the zero-g reference, the joint servo with these gains."""
        base, start, time = EmulatedSystem.load(self.emulated), np.array(self.start), self._times()
        changes: dict[str, object] = {
            "servo.stiffness": gains.stiffness.tolist(),
            "servo.damping": gains.damping.tolist(),
            "servo.integral": [0.0, 0.0, 0.0],
        }
        if not self.friction:
            changes["arm.damping"] = [0.0, 0.0, 0.0]
        commands = np.tile(np.array(self.q), (len(time), 1))
        motion = zero_gravity_motion(plant.with_values(changes), base, commands, CYCLE, start)
        energy = strain_energy(base, motion.pose)
        split = self.builder(plant, printed=False)(gains)
        return NonlinearRelease(
            energy=energy,
            integral=float(np.trapezoid(energy, dx=CYCLE)),
            integral_linear=strain_energy_integral(split, start, float(time[-1])),
            joint_peak=np.max(np.abs(motion.q - commands), axis=0),
        )

    def carry_out(self, conduct: RunContext) -> Result:
        """Search, release, write `release.csv` with translation and energy over time.

        Raises:
            VesTwinError: a base or a pose that cannot be.
        """
        plant = conduct.plant or Plant.load(self.plant)
        conduct.progress(0.0, "gain search")
        sets = {
            "pped": PPED_GAINS,
            "high": HIGH_GAINS,
            "estimator": self.best_estimator(plant),
            "energy": self.least_energy(plant),
        }
        releases: Releases = {}
        for k, (name, gains) in enumerate(sets.items()):
            conduct.progress((k + 1) / (len(sets) + 1), f"release, {name}")
            releases[name] = self.release(plant, gains), self.nonlinear(plant, gains)
        columns: dict[str, FloatArray] = {"t [s]": self._times()}
        for name, (linear, nonlinear) in releases.items():
            columns[f"{name}.translation [m]"] = np.linalg.norm(linear.pose[:, :3], axis=1)
            columns[f"{name}.energy [J]"] = linear.energy
            columns[f"{name}.energy_nonlinear [J]"] = nonlinear.energy
        write_table(conduct.folder / "release.csv", columns)
        conduct.progress(1.0, "written")
        values: dict[str, JsonValue] = {
            name: _figures(*release) for name, release in releases.items()
        }
        return Result(Outcome.COMPLETED, {"zero_g": values}, _lines(releases))

    def _search(self, plant: Plant, measure: Measure) -> JointGains:
        build, bounds = self.builder(plant, printed=True), (self.smallest_gain, self.largest_gain)
        return search_gains(build, measure, [PPED_GAINS, HIGH_GAINS], bounds).gains

    def _times(self) -> FloatArray:
        return CYCLE * np.arange(round(self.duration / CYCLE) + 1, dtype=float)


Releases = dict[str, tuple[Release, NonlinearRelease]]


def _figures(release: Release, nonlinear: NonlinearRelease) -> dict[str, JsonValue]:
    high = release.energy > 0.1 * release.energy[0]
    upper = release.poles[release.poles.imag >= 0]
    return {
        "stiffness": release.gains.stiffness.tolist(),
        "damping": release.gains.damping.tolist(),
        "estimator": release.estimator,
        "poles": [[float(p.real), float(p.imag)] for p in upper],
        "energy_integral": release.integral,
        "energy_integral_split_inertias": nonlinear.integral_linear,
        "energy_integral_nonlinear": nonlinear.integral,
        "last_time_above_10_percent": float(CYCLE * np.nonzero(high)[0][-1]),
        "joint_peak": nonlinear.joint_peak.tolist(),
    }


def _lines(releases: Releases) -> tuple[str, ...]:
    head = "  gains       K 1, 2, 3 [N m/rad]     B 1, 2, 3 [N m s/rad]   estimator  energy [J s]"
    rows = []
    for name, (release, nonlinear) in releases.items():
        k = "".join(f"{value:7.1f}" for value in release.gains.stiffness)
        b = "".join(f"{value:8.2f}" for value in release.gains.damping)
        split = f"(split inertias {nonlinear.integral_linear:.2f}"
        rows.append(
            f"  {name:<10}{k} {b} {release.estimator:8.2f} {release.integral:8.2f}"
            f"  {split}, nonlinear {nonlinear.integral:.2f})"
        )
    gain = 1 - releases["energy"][0].integral / releases["pped"][0].integral
    return (head, *rows, "", f"  energy gains over the thesis's PPED gains: {gain:.0%} less")
