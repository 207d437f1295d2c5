"""A ROS 2 log of joint states is drafted by the names that its messages hold."""

import numpy as np
import pytest
from drafted import drafted
from joint_states import write_joint_states

NAMES = ("bend", "turn", "lift")
"""Of the arm's joints, in another order than the model has them."""

OF = {"turn": 1, "lift": 2, "bend": 3}


@pytest.mark.parametrize("speeds", [True, False])
def test_joint_states_need_no_map(arm, columns, tmp_path, speeds):
    def fields(k):
        found = {"position": "q", "effort": "tau"} | ({"velocity": "dq"} if speeds else {})
        return {f: [columns[f"{c}{OF[n]}"][k] for n in NAMES] for f, c in found.items()}

    at = (1e9 * columns["t"]).astype(int).tolist()
    log = write_joint_states(
        tmp_path / "log.mcap",
        ((10**15 + t, 10**15 + t, NAMES, fields(k)) for k, t in enumerate(at)),
    )
    _, rig = drafted(arm, log)
    told = rig.description.signals
    places = {f"{name}.position": f"/joint_states.position[{k}]" for k, name in enumerate(NAMES)}
    assert {n: c.columns[0] for n, c in told.items() if n in places} == places
    efforts = {n: c.columns[0] for n, c in told.items() if n.endswith(".effort")}
    motors = {f"m{OF[n]}.effort": f"/joint_states.effort[{k}]" for k, n in enumerate(NAMES)}
    assert efforts == motors
    assert np.isclose([told[n].scale for n in motors], 1.0).all()


@pytest.mark.parametrize("order", [(1, 2, 3), (3, 1, 2), (2, 1, 3)])
def test_a_place_in_an_array_is_no_number_of_a_joint(arm, columns, tmp_path, order):
    """Of joint_1 to joint_3 place 1 was taken for joint_1, and two joints for locked ones."""
    text = arm.read_text()
    for name, number in OF.items():
        text = text.replace(f'"{name}"', f'"joint_{number}"')
    arm.write_text(text)
    names = [f"joint_{n}" for n in order]
    at = (1e9 * columns["t"]).astype(int).tolist()
    fields = ({"position": [columns[f"q{n}"][k] for n in order],
               "effort": [columns[f"tau{n}"][k] for n in order]} for k in range(len(at)))  # fmt: skip
    messages = ((10**15 + t, 10**15, names, told) for t, told in zip(at, fields, strict=True))
    found, rig = drafted(arm, write_joint_states(tmp_path / "log.mcap", messages))
    told = rig.description.signals
    for k, n in enumerate(order):
        assert told[f"joint_{n}.position"].columns == (f"/joint_states.position[{k}]",)
        assert told[f"m{n}.effort"].columns == (f"/joint_states.effort[{k}]",)
    assert not any("locked" in words for words in found.look)
