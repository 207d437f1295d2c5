"""Further channels: the one that shows what the others confuse is ranked first."""

import json
from dataclasses import replace

import numpy as np
import pytest
from toy import Toy, programme, shape

from ves_twin.core.errors import InvalidInputError
from ves_twin.diagnosis.experiment.further_channel import further_channels
from ves_twin.diagnosis.model.forward import Channel
from ves_twin.diagnosis.settings import Settings


class Four(Toy):
    """Lag and late are the same in two channels; a third shows late alone, a fourth is noisy."""

    def __init__(self):
        super().__init__(causes=("lag", "late", "friction"))

    @property
    def identity(self):
        return "four"

    @property
    def channels(self):
        own = super().channels
        more = (("late", 0.01), ("noisy", 100.0))
        return (*own, *(Channel(name, "out", 2 + k, "1", sd) for k, (name, sd) in enumerate(more)))

    def simulate(self, programme, values, refined=False):
        own = super().simulate(programme, values, refined)
        u = programme.drive["drive.u"][:, 0]
        alone = dict(values).get("late.size", 0.0) * shape("late", u, programme.time)[:, :1]
        return np.hstack([own, alone, alone])


def test_the_channel_that_parts_what_is_confused_comes_first():
    found = further_channels(Four(), programme(), (0, 1), settings=Settings())
    assert found.recorded == ("out.0", "out.1")
    assert found.pairs == (("lag@plant", "late@plant"),)
    assert found.never == 1
    assert found.sigma == pytest.approx(0.0, abs=0.01)
    first, second = found.gained
    assert (first.channel, first.told, first.left) == ("late", 1, 0)
    assert first.sigma > 0.5
    assert (second.channel, second.told, second.left) == ("noisy", 0, 1)
    assert json.loads(found.to_json())["gained"][0]["channel"] == "late"


def test_what_is_asked_in_vain_is_said():
    every = (0, 1, 2, 3)
    with pytest.raises(InvalidInputError, match="--channels names them"):
        further_channels(Four(), programme(), every, settings=Settings())
    with pytest.raises(InvalidInputError, match=r"none by out\.0, out\.1, late"):
        further_channels(Four(), programme(), (0, 1, 2), settings=Settings())


def test_the_bank_of_all_channels_serves_every_choice(tmp_path):
    settings = replace(Settings(), cache=tmp_path)
    first = further_channels(Four(), programme(), (0, 1), settings=settings)
    banks = list(tmp_path.iterdir())
    assert len(banks) == 1
    assert further_channels(Four(), programme(), (0, 1), settings=settings) == first
    assert list(tmp_path.iterdir()) == banks
