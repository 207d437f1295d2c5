"""is_cyclic: a wheel about its own axis is, a joint that carries weight or inertia off it is not."""

import mujoco
import numpy as np
import pytest

from ves_twin.machines.mjcf.parts.cyclic import is_cyclic, turned_by

FLOATER = """
<mujoco>
  <option gravity="0 0 {gravity}"/>
  <worldbody><body name="base">
    <joint name="x" type="slide" axis="1 0 0"/>
    <joint name="tilt" axis="0 1 0"/>
    <geom size="0.2 0.2 0.1" type="box" mass="5"/>
    <body name="wheel" pos="0.1 0 0.1"><joint name="wheel" axis="0 0 1"/>
      <geom type="cylinder" size="0.1 0.01" mass="0.5"/>{weight}</body>
    <body name="arm" pos="0.2 0 0"><joint name="arm" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="0.4"/></body>
  </body></worldbody>
</mujoco>
"""
OFF_CENTRE = '<geom size="0.01" pos="0.08 0 0" mass="0.01"/>'


@pytest.mark.parametrize(
    ("weight", "gravity", "expected"),
    [
        ("", -9.81, {"x", "wheel"}),
        ("", 0.0, {"x", "wheel"}),  # a tilted base is pushed along x by other efforts
        (OFF_CENTRE, -9.81, {"x"}),
    ],
)
def test_joints_whose_position_changes_no_effort_are_told(weight, gravity, expected):
    model = mujoco.MjModel.from_xml_string(FLOATER.format(weight=weight, gravity=gravity))
    flags = model.opt.disableflags
    names = [model.joint(i).name for i in range(model.njnt)]
    found = {name for name in names if is_cyclic(model, name)}
    assert found == expected
    assert model.opt.disableflags == flags


def test_an_angle_is_the_speed_summed_up():
    time = np.linspace(0.0, 2.0, 2001)
    turned = turned_by(3.0 * np.cos(3.0 * time), time)
    # trapezia of 1 ms leave h^2 / 12 of the third derivative's span
    np.testing.assert_allclose(turned, np.sin(3.0 * time), atol=1e-6)
