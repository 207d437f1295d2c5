"""Picture: the rig as MuJoCo draws it, off screen or in a window."""

from __future__ import annotations

import os
import sys
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from ves_twin.core.errors import VesTwinError

WIDTH, HEIGHT = 640, 480
"""Pixels; MuJoCo's own off-screen buffer."""

VIEW = (0.0, 0.0, 1.25), 4.4, 128.0, -14.0
"""Point looked at [m], distance [m], azimuth and elevation [deg]: an arm straight up fits."""


class NoPictureError(VesTwinError):
    """No OpenGL that draws off screen, or no display for a window."""


class Picture:
    """Draws a copy of the state, so that looking changes nothing.

    Args:
        window: whether to show a window in place of making pictures.
    """

    def __init__(self, window: bool) -> None:
        self._window = window
        self._model: mujoco.MjModel | None = None
        self._opened: _Window | _OffScreen | None = None

    def show(self, model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.uint8] | None:
        """The picture (HEIGHT, WIDTH, 3), or None where the window shows it.

        Raises:
            NoPictureError: nothing here can draw.
        """
        if model is not self._model or self._opened is None:
            self.close()
            self._opened = _Window(model) if self._window else _OffScreen(model)
            self._model = model
        return self._opened.draw(model, data)

    def close(self) -> None:
        """Close window or off-screen buffer."""
        if self._opened is not None:
            self._opened.close()
        self._opened, self._model = None, None


def check_off_screen() -> None:
    """Raise NoPictureError where no picture can be made off screen."""
    _gl_context().free()


class _OffScreen:
    """MuJoCo's classic renderer on a context of our own choice.

    `mujoco.Renderer` chooses its context when MuJoCo is imported, by MUJOCO_GL alone; a server
    without a display and without that variable would then have none.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self._gl = _gl_context()
        self._gl.make_current()
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150.value)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)
        self._scene = mujoco.MjvScene(model, 2000)
        self._option, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        _look(self._camera)
        self._copy = mujoco.MjData(model)

    def draw(self, model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.uint8]:
        self._gl.make_current()
        mujoco.mj_copyData(self._copy, model, data)
        mujoco.mj_forward(model, self._copy)
        everything = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(
            model, self._copy, self._option, None, self._camera, everything, self._scene
        )
        view = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)
        mujoco.mjr_render(view, self._scene, self._context)
        pixels = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_readPixels(pixels, None, view, self._context)
        return np.flipud(pixels).copy()

    def close(self) -> None:
        self._gl.make_current()
        self._context.free()
        self._gl.free()


class _Window:
    """MuJoCo's passive viewer."""

    def __init__(self, model: mujoco.MjModel) -> None:
        if _headless():
            raise NoPictureError(
                "render_mode 'human' needs a display, and there is none; use 'rgb_array'"
            )
        import mujoco.viewer

        self._copy = mujoco.MjData(model)
        panels = {"show_left_ui": False, "show_right_ui": False}
        self._viewer = mujoco.viewer.launch_passive(model, self._copy, **panels)
        _look(self._viewer.cam)

    def draw(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        mujoco.mj_copyData(self._copy, model, data)
        mujoco.mj_forward(model, self._copy)
        self._viewer.sync()

    def close(self) -> None:
        self._viewer.close()


def _look(camera: Any) -> None:
    camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = VIEW


def _headless() -> bool:
    return sys.platform == "linux" and not {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ)


def _gl_context() -> Any:
    """MuJoCo's own choice of context, or EGL on a Linux machine without a display."""
    try:
        if _headless() and not os.environ.get("MUJOCO_GL"):
            from mujoco.egl import GLContext
        else:
            from mujoco.rendering.classic.gl_context import GLContext
        return GLContext(WIDTH, HEIGHT)
    except Exception as error:  # each platform has errors of its own
        name = type(error).__name__
        raise NoPictureError(
            f"no OpenGL that draws off screen ({name}); install EGL or set MUJOCO_GL"
        ) from error
