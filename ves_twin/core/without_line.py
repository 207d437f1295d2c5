"""without_line: a signal less its drift."""

from __future__ import annotations

import numpy as np

from ves_twin.core.types import FloatArray


def without_line(rows: FloatArray) -> FloatArray:
    """Rows (n,) or (n, k) less their straight lines: a drift goes along with every slow column."""
    line = np.vander(np.linspace(-1.0, 1.0, len(rows)), 2)
    return np.asarray(rows - line @ np.linalg.lstsq(line, rows, rcond=None)[0])
