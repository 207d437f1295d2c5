"""Seven-axis arm: motion fed in, torques compared; masses of its CAD, no friction, no rotors.

Torques are compared up to 8 Hz, as far as the motion is known: half the rate of the grid.
"""

from __future__ import annotations

from pathlib import Path

from real.machine import OF_JOINTS, Set, effects, machine, of_urdf, read

TORQUES = (18, 100, 35, 35, 6, 7, 1)
"""Typical torque [N m] of each joint, read off the recordings; speeds are near 1.5 rad/s."""

MASSES = (5.4372, 4.6815, 2.6054, 2.6465, 2.5198, 1.9096, 0.87838)
PERIOD = 0.02
JOINTS = [f"joint{k}" for k in range(1, 8)]
BODIES = [f"link{k}" for k in range(1, 8)]

CENTRE = "1 cm"
"""Sd of each body's centre along each axis: a drawing without its cables and screws."""

RIPPLES = ["joint1.320", "joint2.320"]
"""Waves a turn that all three recordings show at these joints, of one phase."""

HEAD = """schema = 1
kind = "rig"
name = "xmate7p"
model = "xmate7p.xml"
rate = 16
[clock]
column = "t"
[drive]
mode = "motion"
smoothing = "8 Hz"
"""


def model(urdf: Path) -> str:
    spec = of_urdf(urdf, JOINTS)
    spec.compile()
    return str(spec.to_xml())


def description() -> str:
    text = HEAD + "joints = { " + ", ".join(f'{j} = "q.{j[-1]}"' for j in JOINTS) + " }\n"
    for k, joint in enumerate(JOINTS, 1):
        text += f'[signals."q.{k}"]\ncolumns = ["q{k}_rad"]\nunit = "rad"\n'
        text += f'[signals."torque.{k}"]\ncolumns = ["tau{k}_Nm"]\nunit = "N*m"\n'
        text += f"noise = {0.01 * TORQUES[k - 1]}\n"
        text += f'[compare."torque.{k}"]\nactuator = "motor_{k}"\n'
        text += f"[typical.joint.{joint}]\neffort = {TORQUES[k - 1]}\nspeed = 1.5\ntravel = 2\n"
        text += f'[typical.signal."torque.{k}"]\nspan = {TORQUES[k - 1]}\n'
    for body, mass in zip(BODIES, MASSES, strict=True):
        text += f'[[parameters]]\nbody = "{body}"\nattribute = "mass"\nsd = {0.05 * mass}\n'
        for axis in "xyz":
            text += f'[[parameters]]\nbody = "{body}"\nattribute = "centre_{axis}"\n'
            text += f'sd = "{CENTRE}"\n'
    return text + effects(
        *((kind, JOINTS) for kind in OF_JOINTS),
        ("sensor_gain", [f"torque.{k}.1" for k in range(1, 8)]),
        ("body_mass", BODIES),
        ("mass_centre", [f"{b}.{axis}" for b in BODIES for axis in "xyz"]),
        ("body_inertia", BODIES),
        ("gravity_direction", ["x", "y"]),
        ("ripple", RIPPLES),
    )


def stamped(log: Path, folder: Path) -> Path:
    """The log with a column of time: rows are 20 ms apart by the data's page."""
    head, *rows = log.read_text().splitlines()
    path = folder / log.name
    lines = [f"t,{head}", *(f"{PERIOD * k:.2f},{row}" for k, row in enumerate(rows))]
    path.write_text("\n".join(lines) + "\n")
    return path


def sets(data: Path, folder: Path) -> list[Set]:
    """Two trajectories fitted, the third held out."""
    here = data / "xmate7p_7axis"
    rig = machine(folder, "xmate7p", model(here / "XM7p.urdf"), description())
    one, two, three = (read(rig, stamped(here / f"traj{k}_50Hz.csv", folder)) for k in (1, 2, 3))
    expert = "0.76, 2.14, 0.51, 0.60, 0.34, 0.35, 0.087 N m"
    return [Set("xmate7p", rig, [one, two], [three], expert, "the expert's figure or better")]
