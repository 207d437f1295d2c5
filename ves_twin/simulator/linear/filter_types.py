"""basic_filters: the filter types among which the thesis chose, at one corner."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ves_twin.plant.parameters import ParameterTable
from ves_twin.simulator.linear.leg_loop import leg_period

if TYPE_CHECKING:
    from control import TransferFunction

CORNER = 10.0
"""Corner of the comparison [Hz] (thesis fig. 5-3)."""
RIPPLE, STOP = 1.0, 4.0
"""Pass-band ripple of type 1, assumed, and stop band of type 2, of Table 5-1 [dB]."""


def basic_filters(parameters: ParameterTable) -> dict[str, TransferFunction]:
    """Second-order Butterworth and Chebyshev types 1 and 2 at the rate of the leg loop.

    The thesis names three basic types without saying which; these are assumed.
    """
    from control import TransferFunction  # slow to import
    from scipy.signal import butter, cheby1, cheby2

    period = leg_period(parameters)
    rate = 1.0 / period
    designs = {
        "Butterworth": butter(2, CORNER, fs=rate),
        "Chebyshev type 1": cheby1(2, RIPPLE, CORNER, fs=rate),
        "Chebyshev type 2": cheby2(2, STOP, CORNER, fs=rate),
    }
    return {name: TransferFunction(b, a, period) for name, (b, a) in designs.items()}
