"""TX40: six-axis arm; motion fed in, torques compared; URDF masses and rotor inertias given.

Beside causes that a machine may have the library holds decoys: viscous and dry friction on the
speed that another joint has in the recording run backwards. Every proved decoy is a false one.
"""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from real.machine import Set, effects, machine, of_urdf, read, stretch

ROTORS = (0.362, 0.362, 0.0988, 0.0313, 0.0468, 0.0105)
"""Drive inertias at the joints [kg m^2], published with the data."""

TORQUES = (60, 80, 40, 10, 10, 4)
SPEEDS = (4.0, 3.0, 4.0, 5.0, 5.0, 8.0)
"""Typical torque [N m] and speed [rad/s] of each joint, read off the recording."""

JOINTS = [f"joint_{k}" for k in range(1, 7)]
PAIRS = [f"{sign}_{k}_{k + 1}" for k in range(1, 6) for sign in ("sum", "difference")]
DECOYS = [f"decoy_{k}" for k in range(1, 7)]
BODIES = [f"link_{k}" for k in range(1, 7)]

WEAK = 0.1
"""Share of its own speed that a joint has in a decoy: its trace is that of the other motion."""

HEAD = """schema = 1
kind = "rig"
name = "tx40"
model = "tx40.xml"
rate = 50
[clock]
column = "t"
[drive]
mode = "motion"
smoothing = "25 Hz"
"""


def model(urdf: Path) -> str:
    """MJCF of the URDF: no shapes, no contacts, no limits; tendons that may couple neighbours."""
    spec = of_urdf(urdf, JOINTS)
    for name, rotor in zip(JOINTS, ROTORS, strict=True):
        spec.joint(name).armature = rotor
    for k, decoy in enumerate(DECOYS, 1):  # a body that nothing holds, moved by the recording
        body = spec.worldbody.add_body(name=decoy)
        body.mass, body.inertia, body.ipos = 1.0, [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]
        body.explicitinertial = True
        body.add_joint(name=decoy, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        tendon = spec.add_tendon(name=f"to_{decoy}")
        tendon.wrap_joint(f"joint_{k}", WEAK)
        tendon.wrap_joint(decoy, 1.0)
    for pair in PAIRS:
        sign, one, two = pair.split("_")
        tendon = spec.add_tendon(name=pair)
        tendon.wrap_joint(f"joint_{one}", 1.0)
        tendon.wrap_joint(f"joint_{two}", 1.0 if sign == "sum" else -1.0)
    spec.compile()
    return str(spec.to_xml())


def description() -> str:
    """What the columns are, what is known how well, and what may be wrong."""
    text = HEAD
    moved = [f'{j} = "q.{j[-1]}"' for j in JOINTS] + [f'{d} = "backwards.{d[-1]}"' for d in DECOYS]
    text += "joints = { " + ", ".join(moved) + " }\n"
    for k, joint in enumerate(JOINTS, 1):
        text += f'\n[signals."q.{k}"]\ncolumns = ["q{k}"]\nunit = "rad"\n'
        text += f'[signals."backwards.{k}"]\ncolumns = ["b{k}"]\nunit = "rad"\n'
        text += f'[signals."torque.{k}"]\ncolumns = ["tau{k}"]\nunit = "N*m"\nnoise = 0.05\n'
        text += f'[compare."torque.{k}"]\nactuator = "motor_{k}"\n'
        text += f"[typical.joint.{joint}]\neffort = {TORQUES[k - 1]}\nspeed = {SPEEDS[k - 1]}\n"
        text += "travel = 2.0\n"
        text += f'[typical.signal."torque.{k}"]\nspan = {TORQUES[k - 1]}\n'
        other = SPEEDS[k % 6]
        text += f"[typical.joint.{DECOYS[k - 1]}]\neffort = {TORQUES[k - 1]}\nspeed = {other}\n"
        text += "travel = 2.0\n"
        text += f'[[parameters]]\njoint = "{joint}"\nattribute = "armature"\n'
        text += f"sd = {0.1 * ROTORS[k - 1]}\n"
    for body, mass in zip(BODIES, (10.5, 3.6, 4.07, 3.62, 1.02, 0.2), strict=True):
        text += f'[[parameters]]\nbody = "{body}"\nattribute = "mass"\nsd = {0.05 * mass}\n'
    torques = [f"torque.{k}" for k in range(1, 7)]
    return text + effects(
        ("viscous_friction", JOINTS),
        ("coulomb_friction", JOINTS),
        ("viscous_asymmetry", JOINTS),
        ("coulomb_asymmetry", JOINTS),
        ("stribeck_friction", JOINTS),
        ("quadratic_drag", JOINTS),
        ("force_offset", JOINTS),
        ("joint_spring", JOINTS),
        ("rotor_inertia", JOINTS),
        ("coupling_inertia", PAIRS),
        ("coupling_viscous", PAIRS),
        ("coupling_coulomb", PAIRS),
        ("coupling_viscous", [f"to_{d}" for d in DECOYS]),
        ("coupling_coulomb", [f"to_{d}" for d in DECOYS]),
        ("actuator_delay", [f"motor_{k}" for k in range(1, 7)]),
        ("sensor_gain", [f"{t}.1" for t in torques]),
        ("body_mass", BODIES),
        ("mass_centre", [f"{b}.{axis}" for b in BODIES for axis in "xyz"]),
        ("body_inertia", BODIES),
    )


def with_decoys(log: Path, folder: Path) -> Path:
    """The log with b1 to b6: the angle of the next joint, backwards in time."""
    table = np.genfromtxt(log, delimiter=",", names=True, comments="#")
    names = list(table.dtype.names or ())
    back = [table[f"q{k % 6 + 1}"][::-1] for k in range(1, 7)]
    rows = np.column_stack([*(table[n] for n in names), *back])
    path = folder / "with_decoys.csv"
    head = ",".join([*names, *(f"b{k}" for k in range(1, 7))])
    np.savetxt(path, rows, "%.9g", ",", header=head, comments="")
    return path


def sets(data: Path, folder: Path) -> list[Set]:
    """Both halves of the one recording, each fitted with the other held out."""
    rig = machine(folder, "tx40", model(data / "tx40" / "tx40.urdf"), description())
    whole = read(rig, with_decoys(data / "tx40" / "tx40.csv", folder))
    halves = [stretch(whole, 0.0, 4.5), stretch(whole, 4.5, 9.1)]
    return [
        Set(f"tx40, fit {a}", rig, [halves[i]], [halves[1 - i]], "18.8 %, 13.5 %", "<= 10 %")
        for i, a in enumerate(("first half", "second half"))
    ]
