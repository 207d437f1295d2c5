"""data_frame: a recording as a pandas DataFrame, indexed by time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ves_twin.core.errors import VesTwinError

if TYPE_CHECKING:
    import pandas as pd

    from ves_twin.core.recording.recording import Recording


def data_frame(recording: Recording) -> pd.DataFrame:
    """One column for each column of a signal, named as in files: `leg.length.1` is leg 1.

    Returns:
        The rows with index `t` [s]; `frame.attrs["units"]` maps a column to its unit.

    Raises:
        VesTwinError: pandas is not installed.
    """
    try:
        import pandas as pd
    except ImportError:
        raise VesTwinError(
            "to_pandas needs pandas, which is not installed: pip install 'ves_twin[pandas]'"
        ) from None
    signals = [recording.info.signal(name) for name in recording.signals]
    columns = [column for signal in signals for column in signal.columns]
    units = [unit for signal in signals for unit in signal.units]
    rows = np.hstack([np.empty((len(recording), 0)), *recording.signals.values()])
    frame = pd.DataFrame(rows, index=pd.Index(recording.time, name="t"), columns=columns)
    frame.attrs["units"] = dict(zip(columns, units, strict=True))
    return frame
