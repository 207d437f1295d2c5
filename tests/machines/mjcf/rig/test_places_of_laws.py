"""Laws depend on what a log tells: a simulation alone is no witness of where a joint was."""

from dataclasses import replace

import pytest
import two_link

from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.rig.description import Mode


@pytest.mark.parametrize("told", [True, False])
def test_no_law_depends_on_a_joint_that_no_column_tells(tmp_path, told):
    rig = two_link.rig(tmp_path)
    description = rig.description
    if not told:
        compare = {n: c for n, c in description.compare.items() if c.joint == "rail"}
        drive = description.drive.model_copy(update={"joints": {}})
        description = description.model_copy(update={"compare": compare, "drive": drive})
    places = MjcfForward.of(replace(rig, description=description), Mode.CONTROL).law_places()
    variables = {v.name for place in places for v in place.variables}
    assert {"position@rail", "speed@rail", "time"} <= variables
    assert ({"position@swing", "speed@swing"} <= variables) is told
