"""MjcfCase: a recording held against an MJCF machine in one mode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ves_twin.core.errors import InvalidInputError, UnknownNameError
from ves_twin.core.recording.recording import POSES, Recording
from ves_twin.core.signals import Signal
from ves_twin.core.types import FloatArray
from ves_twin.data.quality.gate import quality_gate
from ves_twin.diagnosis.model.forward import Excitation
from ves_twin.diagnosis.record.residuals.noise import Noise, NoiseSource
from ves_twin.effects.law import held_words, variable_along
from ves_twin.machines.case import Case, Traces
from ves_twin.machines.mjcf.motion.forward import MjcfForward
from ves_twin.machines.mjcf.motion.pieces import pieces
from ves_twin.machines.mjcf.motion.started import lead_rows
from ves_twin.machines.mjcf.recordings.applied import applied
from ves_twin.machines.mjcf.recordings.experiment import MjcfExperiment
from ves_twin.machines.mjcf.recordings.signals import rig_signals, with_signals
from ves_twin.machines.mjcf.rig.description import Mode
from ves_twin.machines.mjcf.rig.machine import Rig
from ves_twin.machines.mjcf.rig.places import typical_span

FORGET = 1.0
"""Time [s] at the begin that is not compared in forward simulation: a start is read from noisy
rows, and a controller's memory is empty."""

FORGOTTEN = 0.1
"""Share of a recording that this may take: of servos' logs of 2 and 3 s it took half."""

SHORT = 0.2
"""Length [s] below which it takes all of FORGET: so short is a log whose clock has another unit."""

FORGETS = "while a start that is read from noisy rows settles"
"""Why."""

FEWEST = 8
"""Rows that are compared at least: a spectrum and its errors need some."""

SAME = 1e-6
"""Share of a set-point's span by which two recordings of one programme may differ: the digits that
a log is written with."""

NARROWER = 0.5
"""Share of the rows from which on a diagnosis compares so much less that it is told."""


@dataclass(frozen=True, kw_only=True)
class MjcfCase(Case):
    """By the forward of one mode."""

    forward: MjcfForward

    @property
    def machine(self) -> str:
        """Of the machine's file."""
        return self.forward.rig.description.name

    @property
    def identity(self) -> str:
        """Of both files."""
        return self.forward.rig.identity

    @property
    def mode(self) -> str:
        """Of the forward; of a model that is let go "free"."""
        return self.forward.mode.value if self.forward.fed else "free"

    @cached_property
    def signals(self) -> Mapping[str, Signal]:
        """Those of the machine's file."""
        return {signal.name: signal for signal in rig_signals(self.forward.rig)}

    @property
    def same(self) -> Mapping[str, FloatArray]:
        """What is fed in, without the signals that only tell a start."""
        return {name: SAME * np.ptp(self.recording[name], axis=0) for name in self.forward.fed}

    @property
    def leaders(self) -> Mapping[str, str]:
        """Set-point or motion of the joint that an output belongs to."""
        return self.forward.leaders

    @property
    def imposed(self) -> tuple[str, ...]:
        """Those of the machine's file."""
        return self.forward.rig.description.drive.imposed

    @property
    def rate(self) -> float:
        """Of the machine's file."""
        return self.forward.rig.description.rate

    def simulated(self) -> Traces:
        """All that this mode predicts, piece by piece as a diagnosis simulates it.

        Raises:
            InvalidInputError: a simulation that diverges, a joint whose start no row tells.
        """
        forward = self.forward
        lead = lead_rows(forward.rig, self.recording.time)
        found = [
            forward.simulate(Excitation.of(piece, forward.drive, rate=self.rate), {})
            for piece in _pieces(forward, self.recording)
        ]
        rows = np.concatenate([piece[lead if k else 0 :] for k, piece in enumerate(found)])
        if not np.all(np.isfinite(rows)):
            came = f"a simulation of {self.name} ({self.mode}) that diverges"
            expected = "a finite motion; try a smaller timestep"
            raise InvalidInputError(forward.rig.description.model, came, expected)
        columns: dict[str, list[int]] = {}
        for c, channel in enumerate(forward.channels):
            columns.setdefault(channel.signal, []).append(c)
        return {name: rows[:, at] for name, at in columns.items()}

    def declared_noise(self) -> dict[str, Noise]:
        """White, as the machine's file declares it."""
        sources = {True: NoiseSource.DECLARED, False: NoiseSource.NOBODY}
        return {
            c.name: Noise(c.sd, (), 0.0, 1.0, 0.0, sources[c.sd > 0.0])
            for c in self.forward.channels
        }


def mjcf_cases(
    name: str,
    recording: Recording,
    experiment: MjcfExperiment,
    rig: Rig,
    standstill: Recording | None,
) -> tuple[MjcfCase, ...]:
    """A recording in the mode of the machine's file, and closed loop where it has controllers.

    Raises:
        UnknownNameError: none of the signals that a mode predicts is recorded.
        VesTwinError: an experiment that does not fit the machine or the recording.
    """
    ready, own, start = applied(name, recording, experiment, rig)
    checks = () if ready.info.log == POSES else quality_gate(with_signals(recording, rig)).checks
    found = []
    for mode in modes_of(own, ready):
        forward = MjcfForward.of(own, mode)
        outputs = tuple(n for n in forward.compared if n in ready.signals)
        if not outputs:
            wanted = forward.channels[0].signal
            raise UnknownNameError("signal in the recording", wanted, ready.signals)
        time = ready.time - ready.time[0]
        fed = mode is Mode.MOTION or ready.info.log == POSES
        settles = min(FORGET, FORGOTTEN * time[-1]) if time[-1] > SHORT else FORGET
        forget = 0.0 if fed else float(settles)
        forget += own.description.drive.lead if mode is Mode.CONTROL else 0.0
        first = int(np.searchsorted(time, max(start, forget) - 1e-9))
        if ready.info.log != POSES and len(time) - first < FEWEST:
            begin = f"the first {max(start, forget):g} s, {FORGETS}, are not compared"
            came = f"{time[-1]:.3g} s, of which {begin}"
            raise InvalidInputError(name, came, "a longer recording: is its clock in that unit?")
        found.append(
            MjcfCase(
                name=name,
                recording=ready,
                forward=forward,
                inputs=forward.drive,
                outputs=outputs,
                absent=tuple(n for n in forward.compared if n not in ready.signals),
                checks=checks,
                notes=(
                    *((f"the first {forget:g} s, {FORGETS}, are not compared",) if forget else ()),
                    *_cut(forward, ready),
                    *_beyond(forward, ready),
                    *_wider(own, ready),
                    *_unsized(own, outputs),
                ),
                rows=slice(first, len(time)),
                offset=0.0,
                standstill=standstill,
            )
        )
    return tuple(found)


def _pieces(forward: MjcfForward, recording: Recording) -> tuple[Recording, ...]:
    """Of `drive.horizon`, in the file's own mode: a closed loop does not run away."""
    own = forward.mode is forward.rig.description.drive.mode
    return pieces(forward.rig, recording) if own else (recording,)


def _cut(forward: MjcfForward, recording: Recording) -> tuple[str, ...]:
    """That the prediction begins anew from what was measured, where it does."""
    count = len(_pieces(forward, recording))
    if count < 2:
        return ()
    horizon = forward.rig.description.drive.horizon
    begin = "each from its measured start"
    return (f"predicted in {count} pieces of about {horizon:g} s, {begin} (drive.horizon)",)


def _beyond(forward: MjcfForward, recording: Recording) -> tuple[str, ...]:
    """Where the motion leaves the range in which a law was seen, beyond which it is held."""
    if not forward.rig.laws:
        return ()
    fed = Excitation.of(recording, forward.drive)
    along, found = forward.visited(fed, {}), []
    for law in forward.rig.laws:
        share = law.beyond(*(variable_along(name, along) for name in law.of))
        if share > 0.0:
            found.append(held_words(law, share))
    return tuple(found)


def _wider(rig: Rig, recording: Recording) -> tuple[str, ...]:
    """That a diagnosis looks at a lower band than this comparison, where it does."""
    rate = rig.description.rate
    rows = (len(recording.time) - 1) / float(np.ptp(recording.time))
    if recording.info.log == POSES or rate > NARROWER * rows:
        return ()
    band = f"a diagnosis looks below {rate / 2.0:.3g} Hz alone"
    return (f"all of {rows:.4g} rows a second are compared; {band}",)


def _unsized(rig: Rig, outputs: Sequence[str]) -> tuple[str, ...]:
    """That a "*" asks for nothing of a signal whose range nobody tells."""
    told = rig.description
    sensed = [name for name in outputs if not told.compare[name].actuator]
    bare = [name for name in sensed if not typical_span(name, told)]
    if not told.effects or not bare:
        return ()
    keys = ", ".join(f"[typical.signal] {name}.span" for name in bare)
    return (f"a diagnosis asks for no gain, offset or delay of {', '.join(bare)} without {keys}",)


def modes_of(rig: Rig, recording: Recording) -> tuple[Mode, ...]:
    """The mode of a machine's file, and closed loop where set-points were recorded."""
    told = rig.description
    own = told.drive.mode
    if not told.controllers or own is Mode.REFERENCE:
        return (own,)
    fed = MjcfForward.of(rig, Mode.REFERENCE).drive
    return (own, Mode.REFERENCE) if all(n in recording.signals for n in fed) else (own,)
