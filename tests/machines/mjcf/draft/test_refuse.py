"""A log from which no machine can be drafted gets one line that says what to change."""

from __future__ import annotations

import numpy as np
import pytest
from drafted import drafted

from ves_twin.core.errors import InvalidInputError


@pytest.mark.parametrize("name", ["joint_counts", "ticks1", "encoder_counts"])
def test_of_an_encoder_s_counts_the_line_says_what_is_asked_for(swing, write, name):
    path, columns = swing
    log = write({"t": columns["t"], "tau": columns["tau"], name: np.round(650.0 * columns["q"])})
    with pytest.raises(InvalidInputError, match=f"{name} as m or rad"):
        drafted(path, log)


def test_of_a_column_of_no_known_kind_no_unit_is_proposed(swing, write):
    path, columns = swing
    log = write({"t": columns["t"], "tau": columns["tau"], "temperature": columns["q"]})
    with pytest.raises(InvalidInputError, match=r"expected a position or speed of joint$"):
        drafted(path, log)
