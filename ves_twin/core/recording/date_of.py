"""date_of: when a recording was made, by its name or by the clock it was imported with."""

from __future__ import annotations

import re
from datetime import UTC, datetime

from ves_twin.core.recording.recording import Recording

_DATE = re.compile(
    r"(?<!\d)((?:19|20)\d\d)[-_.]?([01]\d)[-_.]?([0-3]\d)"
    r"(?:[T_ -]{0,2}([0-2]\d)[-_.:h]?([0-5]\d)(?:[-_.:m]?([0-5]\d))?)?(?!\d)"
)

EPOCH = 5e8
"""Reading of a clock [s] from which it counts from 1970; below it counts from somewhere else."""


def date_of(name: str, recording: Recording) -> datetime | None:
    """Date, with a time of day where there is one; None if nothing tells it.

    Args:
        name: of the file: "2026-03-14.csv", "axis_20260314_0930.parquet".
        recording: whose import noted where its clock began.
    """
    for match in _DATE.finditer(name):
        parts = [int(part) for part in match.groups(default="0")]
        try:
            return datetime(*parts)  # type: ignore[arg-type]
        except ValueError:
            continue
    zero = recording.info.imported.get("zero")
    if isinstance(zero, int | float) and EPOCH < zero < 10.0 * EPOCH:
        return datetime.fromtimestamp(float(zero), UTC).replace(tzinfo=None)
    return None
