"""What the last body of an arm may weigh follows from what its drives gave, not from its flange."""

from __future__ import annotations

import mujoco
import numpy as np
from drafted import drafted
from three_joints import ARM, moved

from ves_twin.machines.mjcf.draft.lifted import lifted
from ves_twin.machines.mjcf.draft.motion import Motion, motion_of

FLANGE = 0.1
"""Mass of the last body in the model [kg]."""

LIGHT = ARM.replace(
    'type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="1"',
    f'type="sphere" size="0.02" pos="0.1 0 0" mass="{FLANGE}"',
)


def motion(model: mujoco.MjModel) -> Motion:
    """Of the arm, at rest with the upper link level."""
    still = {name: np.zeros(400) for name in ("turn", "lift", "bend")}
    return motion_of(model, still, 0.01, 2.0)


def test_the_mass_is_that_whose_weight_takes_all_of_the_effort():
    model = mujoco.MjModel.from_xml_string(LIGHT)
    weight = 9.81 * 0.5  # N m for a kg in front of the upper link, held level
    efforts = [(0, np.full(300, 50.0)), (1, np.full(300, 20.0))]
    found = lifted(model, motion, efforts)
    assert list(found) == ["lower"]
    np.testing.assert_allclose(found["lower"].most, 20.0 / weight, rtol=1e-3)


def test_a_tool_that_the_model_lacks_is_within_the_range_of_the_draft(arm, write):
    """Three times the flange were 0.3 kg; 2 kg are on it."""
    arm.write_text(LIGHT)
    time, q, _, torque = moved(
        mujoco.MjModel.from_xml_string(LIGHT.replace(f'mass="{FLANGE}"', 'mass="2.1"')), 2
    )
    columns = {"t": time} | {f"q{i + 1}": q[i] for i in range(3)}
    _, rig = drafted(arm, write(columns | {f"tau{i + 1}": torque[i] for i in range(3)}))
    own = [e for e in rig.description.effects if (e.kind, *e.on) == ("payload", "lower")]
    assert len(own) == 1
    assert 2.0 < float(str(own[0].largest).removesuffix(" kg")) < 20.0
    assert not any((e.kind, *e.on) == ("body_mass", "lower") for e in rig.description.effects)


def test_a_tool_of_the_model_that_is_not_there_stays_a_mass(arm, write):
    arm.write_text(LIGHT.replace(f'mass="{FLANGE}"', 'mass="2.1"'))
    time, q, _, torque = moved(mujoco.MjModel.from_xml_string(LIGHT), 2)
    columns = {"t": time} | {f"q{i + 1}": q[i] for i in range(3)}
    _, rig = drafted(arm, write(columns | {f"tau{i + 1}": torque[i] for i in range(3)}))
    kinds = {e.kind for e in rig.description.effects if e.on == ("lower",)}
    assert "body_mass" in kinds
    assert "payload" not in kinds
