"""open_viewer: a rerun file in the native viewer, or served to a browser on this machine only."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from urllib.parse import quote

from ves_twin.core.errors import FileAccessError, VesTwinError

LOOPBACK = "127.0.0.1"
START_SECONDS = 15.0
"""Time that the web server has to answer before it counts as failed."""
STOP_SECONDS = 5.0


def open_viewer(path: Path, web: bool) -> int:
    """Show a rerun file until the viewer is closed, or until ctrl-C.

    Whatever listens does so on the loopback address only, and usage statistics stay off.

    Args:
        path: the .rrd file.
        web: serve a page for a browser and print its address to stderr; else open a window.

    Returns:
        Exit code: that of the viewer, 0 if ctrl-C ended it.

    Raises:
        FileAccessError: missing or unreadable file.
        VesTwinError: no display for a window, or the web server did not start.
    """
    try:
        with path.open("rb"):
            pass
    except OSError as error:
        raise FileAccessError(f"cannot read '{path}': {error.strerror}") from None
    try:
        return _serve(path) if web else _show(path)
    except KeyboardInterrupt:
        return 0


def _show(path: Path) -> int:
    if sys.platform == "linux" and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        raise VesTwinError("no display for the rerun window; serve it to a browser with --web")
    with _viewer([str(path), "--bind", LOOPBACK, "--port", "auto"]) as process:
        return process.wait()


def _serve(path: Path) -> int:
    data, page = _two_free_ports()
    ports = ["--port", str(data), "--web-viewer-port", str(page)]
    with _viewer([str(path), "--serve-web", "--bind", LOOPBACK, *ports]) as process:
        _await(process, (data, page))
        source = quote(f"rerun+http://{LOOPBACK}:{data}/proxy", safe="")
        print(f"http://{LOOPBACK}:{page}/?url={source}", file=sys.stderr)
        print("ctrl-C ends the server", file=sys.stderr, flush=True)
        return process.wait()


@contextmanager
def _viewer(arguments: list[str]) -> Iterator[subprocess.Popen[bytes]]:
    """The viewer in a process group of its own, which ends with the block."""
    command = [sys.executable, "-m", "rerun_cli", *arguments]
    process = subprocess.Popen(command, env=_environment(), start_new_session=True)
    before = signal.signal(signal.SIGTERM, _interrupt)
    try:
        yield process
    finally:
        signal.signal(signal.SIGTERM, before)
        _stop(process)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _stop(process: subprocess.Popen[bytes]) -> None:
    # the rerun command only starts the real viewer: the whole group has to go
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, number)
            process.wait(STOP_SECONDS)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            continue


def _environment() -> dict[str, str]:
    """Environment in which rerun sends no usage statistics: it keeps quiet where CI is set.

    It logs warnings alone, unless RUST_LOG asks for more: its own lines would hide the address.
    """
    values = {k: v for k, v in os.environ.items() if k != "FORCE_RERUN_ANALYTICS"}
    values.setdefault("RUST_LOG", "warn")
    return values | {"CI": "true", "TELEMETRY_ENABLED": "false"}


def _two_free_ports() -> list[int]:
    sockets = [socket.socket(), socket.socket()]
    try:
        for s in sockets:
            s.bind((LOOPBACK, 0))
        return [int(s.getsockname()[1]) for s in sockets]
    finally:
        for s in sockets:
            s.close()


def _await(process: subprocess.Popen[bytes], ports: tuple[int, ...]) -> None:
    deadline = time.monotonic() + START_SECONDS
    waiting = list(ports)
    while waiting:
        if process.poll() is not None or time.monotonic() > deadline:
            raise VesTwinError("the rerun web server did not start")
        with socket.socket() as s:
            s.settimeout(1.0)
            if s.connect_ex((LOOPBACK, waiting[0])) == 0:
                waiting.pop(0)
                continue
        time.sleep(0.05)
