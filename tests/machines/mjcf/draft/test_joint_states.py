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
