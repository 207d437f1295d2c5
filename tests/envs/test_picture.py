"""Pictures: content, change with the rig, no effect on it; a plain word where nothing can draw."""

import numpy as np
import pytest
from short_episodes import make_short

from ves_twin.envs.picture import HEIGHT, WIDTH, NoPictureError

DAMPING = "VesTwin/VibrationDamping-v0"


@pytest.fixture
def drawing():
    env = make_short(DAMPING, render_mode="rgb_array")
    env.reset(seed=0)
    try:
        env.render()
    except NoPictureError as error:
        pytest.skip(str(error))
    yield env
    env.close()


def test_a_picture_shows_a_rig_that_moves(drawing):
    first = drawing.render()
    assert first.shape == (HEIGHT, WIDTH, 3)
    assert first.dtype == np.uint8
    assert first.std() > 10.0  # an empty scene is one colour
    for _ in range(10):
        drawing.step(np.ones(3))
    second = drawing.render()
    assert np.mean(np.any(first != second, axis=2)) > 0.01  # the arm has turned


def test_looking_does_not_change_an_episode(drawing):
    drawing.reset(seed=3)
    seen = []
    for _ in range(4):
        seen.append(drawing.step(np.full(3, 0.5))[0])
        drawing.render()
    plain = make_short(DAMPING)
    plain.reset(seed=3)
    np.testing.assert_array_equal(seen, [plain.step(np.full(3, 0.5))[0] for _ in range(4)])


def test_closing_twice_and_drawing_again_is_allowed(drawing):
    drawing.unwrapped.close()
    drawing.unwrapped.close()
    assert drawing.render().std() > 10.0


def test_a_window_without_a_display_is_refused_in_one_line(monkeypatch):
    monkeypatch.setattr("ves_twin.envs.picture.sys.platform", "linux")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    env = make_short(DAMPING, render_mode="human")
    with pytest.raises(NoPictureError, match="display"):
        env.reset(seed=0)
