"""chain: a body and those that carry it, up to the world."""

from __future__ import annotations

from collections.abc import Iterator

import mujoco


def chain(model: mujoco.MjModel, body: int) -> Iterator[int]:
    """The body, the one that it hangs on, and so on; the world is none of them."""
    while body:
        yield body
        body = int(model.body_parentid[body])
