"""RunProgress: a progress bar on stderr, and a keyboard stop at a safe point."""

from __future__ import annotations

import signal
import sys
from types import FrameType, TracebackType
from typing import Any

from tqdm import tqdm

from ves_twin.compiled import compiled_folder


class RunProgress:
    """Called with the time reached; the first Ctrl-C ends the run between two slices."""

    def __init__(self, name: str, duration: float, unit: str = "s") -> None:
        self._bar = tqdm(
            total=duration,
            desc=name,
            file=sys.stderr,
            disable=None,  # silent where stderr is no terminal
            bar_format="{desc} {percentage:3.0f}% |{bar}|"
            + (" {n:.1f}/{total:.1f} s" if unit == "s" else "")
            + " [{elapsed}]",
        )
        self._stopped = False
        self._running = False
        self._before: Any = None

    def __call__(self, reached: float) -> None:
        """Move the bar to the time reached [s]; stop if Ctrl-C was pressed."""
        self._running = True
        self._bar.update(reached - self._bar.n)
        if self._stopped:
            raise KeyboardInterrupt

    def share(self, done: float, what: str) -> None:
        """Move the bar to a share done, 0 to 1, of a total of 1; `what` stands before the bar."""
        self._bar.set_description_str(what)
        self(done)

    def __enter__(self) -> RunProgress:
        if not any(compiled_folder().iterdir()):
            print("compiling the inner loop, once: about half a minute", file=sys.stderr)
        self._before = signal.signal(signal.SIGINT, self._stop)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        signal.signal(signal.SIGINT, self._before)
        self._bar.close()

    def _stop(self, number: int, frame: FrameType | None) -> None:
        if self._stopped or not self._running:  # nothing to keep, or asked twice
            raise KeyboardInterrupt
        self._stopped = True
