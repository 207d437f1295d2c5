"""arm_part: the arm's MJCF with the numbers of thesis Appendix B."""

from __future__ import annotations

import mujoco
import numpy as np

from ves_twin.plant.parameters import ParameterTable


def arm_part(spec: mujoco.MjSpec, parameters: ParameterTable) -> mujoco.MjSpec:
    """Write lengths, masses, inertias, rotors and friction of the arm into the part puma560.xml.

    A link body carries the DH frame before its own joint, so a centre of mass given in link
    frame i (after the joint, at the far end) is shifted by (a_i, 0, d_i).

    Source: thesis B.1, B.2; rotor inertia split into `armature`, errata E-28.
    """
    number, array = parameters.number, parameters.array
    d0, d1, d2, d3 = (number(f"arm.d{i}") for i in range(4))
    a2, a3 = number("arm.a2"), number("arm.a3")
    mass, com, inertia = array("arm.mass"), array("arm.com"), array("arm.inertia")
    shift = np.array([[0.0, 0.0, d0], [0.0, 0.0, 0.0], [a2, 0.0, d2], [a3, 0.0, d3]])
    for i in range(4):
        body = spec.body(f"link{i}")
        body.mass = mass[i]
        body.ipos = com[i] + shift[i]
        body.inertia = inertia[i]
    spec.body("link1").pos = [0.0, 0.0, d0 + d1]
    spec.body("link3").pos = [a2, 0.0, d2]
    spec.site("tip").pos = [a3, 0.0, d3]
    armature, damping = array("arm.armature"), array("arm.damping")
    for i in range(3):
        joint = spec.joint(f"q{i + 1}")
        joint.armature = armature[i]
        joint.damping = np.array([damping[i], 0.0, 0.0])
    return spec
