"""Tables that are no recordings are refused in one line."""

import numpy as np
import pytest

from ves_twin.core.errors import FileAccessError, VesTwinWarning
from ves_twin.core.recording.files import load_recording
from ves_twin.core.recording.recording import RecordingInfo
from ves_twin.core.recording.stream import RecordingStream


def test_a_stream_whose_names_are_no_text_is_refused_in_one_line(tmp_path):
    with RecordingStream(tmp_path, ("leg.length",), RecordingInfo("simulated")) as stream:
        stream.write(np.arange(3.0), {"leg.length": np.ones((3, 6))})
        content = (tmp_path / "recording.arrows").read_bytes()
    bad = tmp_path / "bad.arrows"
    bad.write_bytes(content.replace(b"leg.length.3", b"leg.l\xbdngth.3"))
    changed = pytest.warns(VesTwinWarning, match="was changed since it was written")
    with changed, pytest.raises(FileAccessError, match="no whole batch") as caught:
        load_recording(bad)
    assert "\n" not in str(caught.value)
