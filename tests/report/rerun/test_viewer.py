"""Tests of the viewer: what it refuses, where it listens, and that ctrl-C ends all of it."""

import signal
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

from ves_twin.core.errors import FileAccessError, VesTwinError
from ves_twin.core.recording.recording import Recording, RecordingInfo
from ves_twin.report.rerun.viewer import open_viewer
from ves_twin.report.rerun.write import write_rrd

SERVE = """
import signal, sys
from pathlib import Path
from ves_twin.report.rerun.viewer import open_viewer
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
sys.exit(open_viewer(Path(sys.argv[1]), web=True))
"""


@pytest.fixture
def file(tmp_path) -> Path:
    time = np.arange(10) / 80.0
    recording = Recording(time, {"leg.length": np.ones((10, 6))}, RecordingInfo("measured"))
    return write_rrd(recording, tmp_path / "a.rrd")


@pytest.mark.parametrize("web", [True, False])
def test_a_viewer_of_a_missing_file_gives_one_line(tmp_path, web):
    with pytest.raises(FileAccessError, match="cannot read"):
        open_viewer(tmp_path / "none.rrd", web)


def test_a_window_without_a_display_points_to_the_browser(file, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(VesTwinError, match="--web"):
        open_viewer(file, web=False)


def _answers(address: str, port: int) -> bool:
    with socket.socket() as s:
        s.settimeout(1.0)
        return s.connect_ex((address, port)) == 0


def test_the_web_viewer_listens_on_loopback_only_and_ends_with_ctrl_c(file, monkeypatch):
    monkeypatch.delenv("RUST_LOG", raising=False)
    command = [sys.executable, "-c", SERVE, str(file)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            url = process.stderr.readline().strip()  # nothing of rerun's own stands before it
            assert url.startswith("http://")
            page = urlsplit(url)
            data = urlsplit(parse_qs(page.query)["url"][0])
            ports = (page.port, data.port)
            with urllib.request.urlopen(f"http://{page.netloc}/") as answer:
                assert b"rerun" in answer.read().lower()
            # a server on all addresses would answer here as well
            assert not any(_answers("127.0.0.2", port) for port in ports)
        finally:
            process.send_signal(signal.SIGINT)
            try:
                code = process.wait(20)
            except subprocess.TimeoutExpired:
                process.terminate()  # or the block would wait for ever
                raise
        assert code == 0
    assert not any(_answers("127.0.0.1", port) for port in ports)
