"""BodePlot: gain and phase over frequency, lines of models and points of measurements."""

from __future__ import annotations

from pathlib import Path

from ves_twin.procedures.response.sine_fit import MeasuredResponse
from ves_twin.report.figure import new_figure
from ves_twin.report.picture import PICTURE_WIDTH, save_picture
from ves_twin.simulator.linear.response import FrequencyResponse

HEIGHT = 5.2
"""Height of a picture [inch]."""


class BodePlot:
    """Two axes, magnitude over phase.

    Args:
        title: line above the picture.
    """

    def __init__(self, title: str) -> None:
        self.figure = new_figure(HEIGHT, PICTURE_WIDTH)
        self._gain, self._phase = self.figure.subplots(2, 1, sharex=True)
        self._gain.set_title(title, fontsize=10)
        self._gain.set_ylabel("gain [dB]")
        self._phase.set_ylabel("phase [deg]")
        self._phase.set_xlabel("frequency [Hz]")
        for axes in (self._gain, self._phase):
            axes.set_xscale("log")
            axes.grid(which="both", alpha=0.3)

    def line(self, response: FrequencyResponse, label: str, colour: str) -> None:
        """Draw a model."""
        self._gain.plot(response.frequency, response.decibel, color=colour, lw=1.2)
        self._phase.plot(response.frequency, response.degrees, color=colour, lw=1.2, label=label)

    def points(
        self, response: MeasuredResponse, label: str | None, colour: str, marker: str = "o"
    ) -> None:
        """Draw a measurement."""
        look = {"color": colour, "ls": "none", "ms": 4.5, "mfc": "none", "marker": marker}
        self._gain.plot(response.frequency, response.decibel, **look)
        self._phase.plot(response.frequency, response.degrees, label=label, **look)

    def mark_bandwidth(self) -> None:
        """A thin line where the gain has fallen by 3 dB."""
        self._gain.axhline(-3.0, color="0.5", lw=0.8, ls=":")

    def limit(self, lowest: float, highest: float) -> None:
        """Bounds of the gain [dB]."""
        self._gain.set_ylim(lowest, highest)

    def save(self, path: Path) -> Path:
        """Write the picture as PNG."""
        self._phase.legend(fontsize=7, loc="lower left")
        return save_picture(self.figure, path)
