"""add_tendon_legs: the legs of the fast rig, straight lines of force between their joints."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.mechanics.kinematics.stewart import StewartGeometry

LEG_COLOUR = np.array([0.72, 0.55, 0.20, 1.0])


def add_tendon_legs(
    spec: mujoco.MjSpec, geometry: StewartGeometry, rod_mass: float, rod_radius: float
) -> None:
    """Six spatial tendons leg1 ... leg6 from base joints to platform joints, and the rods' masses.

    A force F on leg i acts on the platform as the wrench J_i' F, J the derivative of the length.
    A rod moves along with its platform, its mass a point: right along the leg, where the oil feels
    it. Across the leg, rod and cylinder of VES II together swing like 1.8 kg instead of 2.5 kg,
    and hang on the joint with 3.5 kg. The point lies at twice the joint's distance from the
    platform's origin, since MuJoCo fills an open `ipos` from `pos`: too much inertia in turning,
    known and left as it was calibrated (docs/limits.md).

    Args:
        spec: rig without legs, whose platform has the sites platform/joint1 ... joint6.
        geometry: joint positions.
        rod_mass: mass of a rod [kg].
        rod_radius: radius of the drawn line [m].
    """
    top, home = spec.body("platform/top"), geometry.lengths(np.zeros(6))
    for i in range(len(geometry.base)):
        name = f"leg{i + 1}"
        spec.worldbody.add_site(name=f"{name}/base", pos=geometry.base[i])
        if rod_mass > 0.0:
            top.add_body(
                name=f"{name}/rod",
                pos=geometry.top[i],
                mass=rod_mass,
                explicitinertial=True,
            )
        leg = spec.add_tendon(name=name, width=rod_radius, rgba=LEG_COLOUR)
        # the length that counts as zero travel, also where an effect moves a joint
        leg.springlength = np.array([home[i], home[i]])
        leg.wrap_site(f"{name}/base")
        leg.wrap_site(f"platform/joint{i + 1}")
