"""An elbow may brake for all of a motion: negative work alone turns no effort."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from drafted import changed, drafted, scales

TWO = """
<mujoco model="two">
  <option gravity="0 0 0"><flag contact="disable"/></option>
  <worldbody><body>
    <joint name="one" axis="0 0 1"/><geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" mass="1"/>
    <body pos="0.3 0 0">
      <joint name="two" axis="0 0 1"/>
      <geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.02" mass="0.5"/>
    </body></body></worldbody>
  <actuator><motor name="motor1" joint="one"/><motor name="motor2" joint="two"/></actuator>
</mujoco>
"""


@pytest.fixture
def braked(arm: Path) -> dict[str, np.ndarray]:
    """A perfect log in which the second motor brakes: the first one swings its link."""
    arm.write_text(TWO)
    model = mujoco.MjModel.from_xml_string(TWO)
    data, time = mujoco.MjData(model), 0.01 * np.arange(800)
    rate = np.array([3.0, 4.3])[:, None]
    one = 0.6 * np.sum(np.sin(rate * time), axis=0)
    two = 0.1 * np.sum(np.sin(rate * time - 1.2), axis=0)
    q = np.stack([one, two])
    v = np.gradient(q, 0.01, axis=1)
    a = np.gradient(v, 0.01, axis=1)
    torque = np.zeros_like(q)
    for k in range(len(time)):
        data.qpos, data.qvel, data.qacc = q[:, k], v[:, k], a[:, k]
        mujoco.mj_inverse(model, data)
        torque[:, k] = data.qfrc_inverse
    # each motor has its friction to overcome as well
    torque += np.array([0.3, 0.01])[:, None] * v
    return {"t": time, "q1": q[0], "q2": q[1], "tau1": torque[0], "tau2": torque[1]}


def work(columns: dict[str, np.ndarray]) -> float:
    """Of the second motor, as a share of the most that it could do."""
    v, y = np.gradient(columns["q2"], 0.01), columns["tau2"]
    return float(v @ y / (np.linalg.norm(v) * np.linalg.norm(y)))


def test_an_effort_that_the_model_explains_keeps_its_sign_though_it_brakes(arm, braked, write):
    assert work(braked) < -0.6
    found, rig = drafted(arm, write(braked))
    assert not any("wrong sign" in words for words in found.look)
    assert scales(rig)["motor2.effort"] == 1.0
    assert found.explained["tau2"] > 0.9


def test_an_effort_that_brakes_is_asked_after_where_the_model_does_not_explain_it(
    arm, braked, write
):
    found, rig = drafted(arm, write(changed(braked, tau2=5.0 * braked["tau2"])))
    assert scales(rig)["motor2.effort"] == 1.0
    assert any(words.startswith("tau2 brakes its joint more") for words in found.look)


def test_an_effort_that_is_turned_is_still_turned(arm, braked, write):
    found, rig = drafted(arm, write(changed(braked, tau2=-braked["tau2"])))
    assert any("tau2 has the wrong sign for this model (slope" in words for words in found.look)
    assert scales(rig)["motor2.effort"] == -1.0
