"""RunProgress: stage, share and time left on stderr, and a keyboard stop at a safe point."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType
from typing import Any

from tqdm import tqdm

FIRST = 1.0
"""A command that is done sooner says nothing [s]: a bad input is then one line alone."""

PAUSE = 10.0
"""Time between two lines where stderr is no terminal [s]: a log of an hour stays readable."""

ASKS = (signal.SIGINT, signal.SIGTERM)
"""Signals that ask for an end: of the keyboard, and of batch systems and `timeout`."""

ENDING = "coming to an end with what is known by now; Ctrl-C again stops without it"
"""What the first Ctrl-C is answered with, where there is something to tell."""


class RunProgress:
    """Called with the amount reached; a first Ctrl-C or SIGTERM ends the work between two slices.

    Work that can tell what it knows by then is brought to its end by `ending`, and only a second
    Ctrl-C stops it.

    A terminal shows a bar for each stage. Anywhere else a line is printed after FIRST and then
    every PAUSE, so that a log, too, tells what is being done and how long that stage still takes.

    Args:
        name: of the work, before every stage.
        total: amount of a stage that tells none of its own.
        unit: "s" for a run, whose amount is its time [s].
        ending: brings the work to its end, and says whether there is something to tell by then.
    """

    def __init__(
        self, name: str, total: float, unit: str = "s", ending: Callable[[], bool] | None = None
    ) -> None:
        self._name, self._total, self._ending = name, total, ending
        self._bar = tqdm(
            total=total,
            desc=name,
            file=sys.stderr,
            disable=None,  # no bar where stderr is no terminal
            bar_format="{desc} {percentage:3.0f}% |{bar}|"
            + (" {n:.1f}/{total:.1f} s" if unit == "s" else "")
            + " [{elapsed}, {remaining} left]",
        )
        self._stage, self._done = "", 0.0
        self._begun = self._stage_begun = self._stage_over = time.monotonic()
        self._asked = self._stopped = self._running = False
        self._before: dict[signal.Signals, Any] = {}
        self._over = threading.Event()
        self._teller = threading.Thread(target=self._tell, daemon=True)

    def __call__(self, reached: float) -> None:
        """Go to the amount reached; stop if Ctrl-C was pressed."""
        self._running = True
        self._done = reached / self._total
        self._bar.update(reached - self._bar.n)
        if self._stopped:
            raise KeyboardInterrupt

    def share(self, done: float, what: str) -> None:
        """Go to a share done, 0 to 1, of a stage; another stage begins its own time."""
        if what != self._stage:
            self._stage, self._stage_begun = what, time.monotonic()
            self._bar.reset()
            self._bar.set_description_str(f"{self._name}: {what}")
        if done >= 1.0:
            self._stage_over = time.monotonic()
        self(done)

    def line(self) -> str:
        """Stage, share, time so far and time left of the stage, as a log shows them."""
        now = time.monotonic()
        what = f"{self._name}: {self._stage}" if self._stage else self._name
        here = now - self._stage_begun
        if self._stage and self._done == 0.0:  # a stage whose end nobody knows
            within = f", {_span(here)} in this stage" if here >= 1.0 else ""
            return f"{what}, {_span(now - self._begun)} so far{within}"
        text = f"{what}, {100.0 * self._done:.0f} %, {_span(now - self._begun)} so far"
        since = now - self._stage_over
        if self._stage and self._done >= 1.0 and since >= 1.0:  # what follows has told no name
            text += f", {_span(since)} since then"
        if 0.0 < self._done < 1.0:
            left = here * (1.0 / self._done - 1.0)
            text += f", about {_span(left)} left" + (" in this stage" if self._stage else "")
        return text

    def __enter__(self) -> RunProgress:
        self._before = {one: signal.signal(one, self._stop) for one in ASKS}
        if self._bar.disable:
            self._teller.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        if self._teller.is_alive():
            self._teller.join()
        for one, before in self._before.items():
            signal.signal(one, before)
        self._bar.close()

    def _tell(self) -> None:
        pause = FIRST
        while not self._over.wait(pause):
            print(self.line(), file=sys.stderr, flush=True)
            pause = PAUSE

    def _stop(self, number: int, frame: FrameType | None) -> None:
        if self._asked or not self._running:  # asked twice, or nothing to keep
            raise KeyboardInterrupt
        self._asked = True
        if self._ending is None:
            self._stopped = True
        elif self._ending():
            print(f"ves-twin: {ENDING}", file=sys.stderr, flush=True)
        else:
            raise KeyboardInterrupt


def _span(seconds: float) -> str:
    """A time as people say it: 8 s, 3 min 20 s, 2 h 5 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"
