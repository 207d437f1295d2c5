"""Hydraulic cylinder: speed by that of the pump under a held-out load; the load by pressures.

Speed is asked in open loop: pump and pressures are fed in. The force of the pressures is asked
where the stroke is fed in; nothing is said of a load.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.signal import savgol_filter

from real.machine import Set, effects, machine, read

CAP, ROD_SIDE = 1.9635e-3, 1.3477e-3
"""Areas of a bore of 50 mm and a rod of 28 mm [m^2]; the rod follows from 0.62 and 0.89 mm a turn,
on the data's page."""

PERIOD, SMOOTH = 0.005, 21
"""Of the rows [s]; rows of the parabola that tells speed: a count of 0.025 mm is 0.1 mm/s then.
Force that is fed in goes through it, too: soft oil would turn counts of pressures into speed."""

DRIVE = """<mujoco model="cylinder">
  <option timestep="1.25e-3" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body name="oil"><joint name="flow" type="slide" axis="1 0 0" damping="1e8"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="rod">
        <joint name="squeeze" type="slide" axis="1 0 0" stiffness="2e7" damping="2e4"/>
        <inertial pos="0 0 0" mass="100" diaginertia="1 1 1"/></body>
    </body>
  </worldbody>
  <tendon><fixed name="stroke">
    <joint joint="flow" coef="1"/><joint joint="squeeze" coef="1"/></fixed></tendon>
  <actuator>
    <motor name="pump" joint="flow" gear="12500"/>
    <motor name="pressures" tendon="stroke" gear="-1"/>
  </actuator>
  <sensor><tendonvel name="speed" tendon="stroke"/></sensor>
</mujoco>
"""
"""A pump that leaks is a force with a damper beside it, oil a spring: 0.2 l of 1 GPa. 0.125 mm a
radian is the mean of both directions on the data's page; 100 kg are nothing at such speeds."""

OPEN = """schema = 1
kind = "rig"
name = "cylinder_speed"
model = "cylinder_speed.xml"
rate = 20
[clock]
column = "t"
[signals.pump]
columns = ["pump"]
unit = "rad/s"
[signals.force]
columns = ["fed"]
unit = "N"
[signals."rod.speed"]
columns = ["speed"]
unit = "m/s"
noise = "0.1 mm/s"
[signals."shown.speed"]
columns = ["shown"]
unit = "m/s"
noise = "0.1 mm/s"
[drive]
mode = "control"
actuators = { pump = "pump", pressures = "force" }
[compare."rod.speed"]
sensor = "speed"
[compare."shown.speed"]
sensor = "speed"
[typical.joint.flow]         # a leak of 1 mm/s under 10 kN is much
effort = "1.25 MN"
speed = "12.5 mm/s"
travel = "50 mm"
[typical.joint.squeeze]
effort = "10 kN"
speed = "12.5 mm/s"
travel = "1 mm"
[typical.signal."rod.speed"]
span = "12.5 mm/s"
[typical.signal."shown.speed"]
span = "12.5 mm/s"
[[effects]]
kind = "joint_compliance"
on = ["squeeze"]
[[effects]]
kind = "cubic_spring"
on = ["squeeze"]
[[effects]]
kind = "viscous_friction"
on = ["flow"]
largest = "95 MN*s/m"
[[effects]]
kind = "actuator_delay"
on = ["pump"]
largest = "150 ms"
[[effects]]
kind = "sensor_delay"
on = ["shown.speed"]
largest = "150 ms"
"""

REST = """<mujoco model="rod">
  <option gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody>
    <body name="rod"><joint name="stroke" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="20" diaginertia="1 1 1"/></body>
  </worldbody>
  <actuator><motor name="pressures" joint="stroke"/></actuator>
  <sensor><jointvel name="speed" joint="stroke"/></sensor>
</mujoco>
"""

GIVEN = """schema = 1
kind = "rig"
name = "cylinder_force"
model = "cylinder_force.xml"
rate = 20
[clock]
column = "t"
[signals.stroke]
columns = ["x"]
unit = "m"
[signals.force]
columns = ["force"]
unit = "N"
noise = 50                   # a quarter of a bar
[signals."shown.speed"]
columns = ["shown"]
unit = "m/s"
noise = "0.1 mm/s"
[drive]
mode = "motion"
joints = { stroke = "stroke" }
smoothing = "8 Hz"
[compare.force]
actuator = "pressures"
[compare."shown.speed"]
sensor = "speed"
[typical.joint.stroke]
effort = "5 kN"
speed = "12.5 mm/s"
travel = "50 mm"
[typical.signal.force]
span = "5 kN"
[typical.signal."shown.speed"]
span = "12.5 mm/s"
[[effects]]
kind = "sensor_delay"
on = ["shown.speed"]
largest = "150 ms"
[[effects]]
kind = "actuator_delay"
on = ["pressures"]
largest = "150 ms"
"""

KINDS = (
    "viscous_friction",
    "coulomb_friction",
    "viscous_asymmetry",
    "coulomb_asymmetry",
    "stribeck_friction",
    "force_offset",
    "joint_spring",
    "one_way_load",
)


PUMP = ("gain", "offset", "deadband", "asymmetry", "saturation")

TRUTH = {2: 3927, 3: 5890, 4: 7854, 5: 9817}
"""Load of each group of recordings [N]: the pressure of the cylinder that makes it, times its
area, on the data's page."""


def sets(data: Path, folder: Path) -> list[Set]:
    """Loads of 0, 4 and 8 kN fitted and 6 kN held out; then each load by its own recordings."""
    here = data / "eha_hydraulic_cylinder"
    logs = {(i, j): even(here, i, j, folder) for i in (1, *TRUTH) for j in (1, 2, 3, 4)}
    of_pump = (f"actuator_{kind}" for kind in PUMP)
    told = OPEN + effects(
        *((kind, ["pump"]) for kind in of_pump),
        ("sensor_gain", ["rod.speed.1", "shown.speed.1"]),
    )
    drive = machine(folder, "cylinder_speed", DRIVE, told)
    fitted = [read(drive, logs[load, step]) for load, step in ((1, 4), (2, 3), (4, 4))]
    held = [read(drive, logs[3, step]) for step in (1, 2, 3, 4)]
    asked = "<= 1.0 mm/s, lag of 60 ms to 20 %"
    found = [Set("cylinder, speed", drive, fitted, held, "1.25 mm/s", asked)]
    told = GIVEN + effects(*((kind, ["stroke"]) for kind in KINDS))
    rest = machine(folder, "cylinder_force", REST, told)
    for load, truth in TRUTH.items():
        groups = [[read(rest, logs[load, step]) for step in steps] for steps in ((4, 2), (3, 1))]
        found.append(Set(f"cylinder, {truth} N", rest, *groups, "-", "load named to 10 %"))
    return found


def even(here: Path, load: int, step: int, folder: Path) -> Path:
    """A log in SI from its second second on, where all filters are full; speed by a parabola."""
    table = np.genfromtxt(here / f"load{load}_step{step}.csv", delimiter=",", names=True)
    rows = slice(400, None)
    force = 1e5 * (CAP * table["pA_bar"] - ROD_SIDE * table["pB_bar"])
    speed = savgol_filter(table["pos_mm"], SMOOTH, 2, deriv=1, delta=PERIOD)
    columns = np.column_stack(
        [
            PERIOD * np.arange(len(table)),
            table["motor_speed_rpm"] * 2.0 * np.pi / 60.0,
            force,
            savgol_filter(force, SMOOTH, 2),
            1e-3 * table["pos_mm"],
            1e-3 * speed,
            1e-3 * table["cyl_speed_mm_s"],
        ]
    )
    path = folder / f"load{load}_step{step}.csv"
    folder.mkdir(parents=True, exist_ok=True)
    head = "t,pump,force,fed,x,speed,shown"
    np.savetxt(path, columns[rows], "%.9g", ",", header=head, comments="")
    return path
