"""write_diagnosis_rrd: a diagnosis: machine, channels and errors by the models before and after."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from rerun.encodings import AbsoluteTimeRange, TimeInt

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import whole_file
from ves_twin.diagnosis.verdict.report_traces import ReportTraces, Traces
from ves_twin.diagnosis.verdict.verdict import Verdict
from ves_twin.machines.drawing import Drawing
from ves_twin.report.colours import AFTER, BEFORE, MEASURED, TOLERANCES, Colour, rgb
from ves_twin.report.diagnosis.answer import (
    confidence_sentence,
    nearest_sentence,
    next_step,
    verdict_sentence,
)
from ves_twin.report.diagnosis.basis import basis_sentences, gain_sentence
from ves_twin.report.diagnosis.words import fitted_word
from ves_twin.report.rerun.colours import BACKGROUND
from ves_twin.report.rerun.heat import send_heat
from ves_twin.report.rerun.series import shown
from ves_twin.report.rerun.three_bodies import send_three_bodies

EYE = np.array([1.0, -2.2, 0.5])
"""Where the machine is looked at from, in sizes of the machine from its middle."""

LOUD = 2.0
"""Rms in sigma of a stretch of time from which an error counts as more than noise."""

BEFORE_ONSET, AFTER_ONSET = 0.5, 2.0
"""Time about the onset that the viewer plays [s]."""


def write_diagnosis_rrd(verdict: Verdict, path: Path, drawing: Drawing | None = None) -> Path:
    """Write a verdict's traces as a rerun file, for the viewer of the same release.

    The timeline is `sim_time` [s]. Entities of recording n: rn/compared/CHANNEL (measured, the
    models), rn/sigma/CHANNEL (before, after), rn/heat (all channels over time), rn/bodies (the
    machine as measured, by the model before and after), rn/events (the onset); `verdict` is the
    text. The viewer opens at the onset.

    Args:
        verdict: from `diagnose`, with its traces.
        path: the .rrd file; one that exists is replaced.
        drawing: bodies of the machine; without them there is no view in 3-D.

    Raises:
        InvalidInputError: a verdict without traces, as from a file.
        FileAccessError: the file cannot be written.
    """
    if verdict.exhibit is None:
        raise InvalidInputError("verdict", "no traces", "one that diagnose has just returned")
    with whole_file(path) as partial:
        _write(verdict, verdict.exhibit, partial, drawing)
    return path


def _write(verdict: Verdict, exhibit: ReportTraces, path: Path, drawing: Drawing | None) -> None:
    stream = rr.RecordingStream("ves_twin diagnosis")
    content = stream.binary_stream()  # see write.py
    stream.send_recording_name(f"diagnosis: {verdict.verdict.value}")
    stream.log("/", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    page = rr.TextDocument(_account(verdict), media_type=rr.MediaType.MARKDOWN)
    stream.log("verdict", page, static=True)
    drawn = None
    for number, traces in enumerate(exhibit.traces, 1):
        root, channels = f"r{number}", exhibit.channels
        for c in range(len(channels)):
            _send_channel(stream, exhibit, traces, c, root, fitted_word(verdict))
        send_heat(stream, f"{root}/heat", channels, traces)
        _send_onset(stream, f"{root}/events", onset_of(exhibit, number - 1))
        if drawing is not None and send_three_bodies(
            stream, f"{root}/bodies", drawing, channels, traces
        ):
            drawn = drawing
    blueprint = diagnosis_blueprint(exhibit, drawn)
    stream.send_blueprint(blueprint, make_active=True, make_default=True)
    path.write_bytes(content.read() or b"")
    stream.disconnect()


def onset_of(exhibit: ReportTraces, recording: int) -> float | None:
    """When the model before first leaves more than noise [s]; None: it never does."""
    loud = [
        cell.low
        for cell in exhibit.before
        if cell.kind == "time"
        and cell.recording == recording
        and cell.energy > LOUD**2 * cell.freedom
    ]
    return min(loud, default=None)


def _send_onset(stream: rr.RecordingStream, entity: str, onset: float | None) -> None:
    if onset is None:
        return
    said = "from here on the error of the model before is more than noise"
    times = [rr.TimeColumn("sim_time", duration=[onset])]
    log = rr.TextLog.columns(text=[said], level=[rr.TextLogLevel.WARN])
    stream.send_columns(entity, times, log)


def _account(verdict: Verdict) -> str:
    said = [
        f"**{verdict_sentence(verdict)}**",
        f"How sure: {confidence_sentence(verdict)}",
        f"What next: {next_step(verdict)}",
        nearest_sentence(verdict),
        gain_sentence(verdict),
    ]
    return "\n\n".join([text for text in said if text] + list(basis_sentences(verdict))) + "\n"


def _send_channel(
    stream: rr.RecordingStream,
    exhibit: ReportTraces,
    traces: Traces,
    c: int,
    root: str,
    fitted: str,
) -> None:
    channel = exhibit.channels[c]
    factor, unit = shown(channel.signal, channel.unit)
    models = (traces.measured, traces.nominal, traces.tolerances, traces.fitted)
    words = ("measured", "model before", "tolerances fitted", fitted)
    names = [f"{word} [{unit}]" for word in words]
    colours = [rgb(name) for name in (MEASURED, BEFORE, TOLERANCES, AFTER)]
    values = factor * np.column_stack([rows[:, c].astype(float) for rows in models])
    _send(stream, f"{root}/compared/{channel.name}", names, colours, traces.time, values)
    left = np.column_stack([traces.before[:, c], traces.after[:, c]])
    names = ["before [sigma]", "after [sigma]"]
    entity = f"{root}/sigma/{channel.name}"
    _send(stream, entity, names, [rgb(BEFORE), rgb(AFTER)], traces.sigma_time, left)


def _send(
    stream: rr.RecordingStream,
    entity: str,
    names: list[str],
    colours: list[Colour],
    time: FloatArray,
    values: FloatArray,
) -> None:
    style = rr.SeriesLines(names=names, colors=colours, widths=[1.5] * len(names))
    stream.log(entity, style, static=True)
    at = [rr.TimeColumn("sim_time", duration=time)]
    stream.send_columns(entity, at, rr.Scalars.columns(scalars=values))


def diagnosis_blueprint(exhibit: ReportTraces, drawn: Drawing | None = None) -> rrb.Blueprint:
    """A first tab for each recording, machine and heat, then one for each of its signals.

    Args:
        exhibit: what is shown.
        drawn: bodies of the machine; None where there are none to show.
    """
    several = len(exhibit.traces) > 1
    signals = list(dict.fromkeys(channel.signal for channel in exhibit.channels))
    tabs = []
    for number, traces in enumerate(exhibit.traces, 1):
        title = f"{traces.name}: overview" if several else "overview"
        tabs.append(_overview(exhibit, f"r{number}", title, drawn))
        for signal in signals:
            names = [c.name for c in exhibit.channels if c.signal == signal]
            title = f"{traces.name}: {signal}" if several else signal
            tabs.append(_tab(title, names, f"r{number}"))
    text = rrb.TextDocumentView(origin="/verdict", name="Verdict")
    onset = onset_of(exhibit, 0)
    return rrb.Blueprint(
        rrb.Horizontal(rrb.Tabs(*tabs, active_tab=0), text, column_shares=[4, 1]),
        rrb.TopPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        _time_panel(onset),
        auto_layout=False,
        auto_views=False,
    )


def _time_panel(onset: float | None) -> rrb.TimePanel:
    """Paused; what is played, if anything, is the time about the onset."""
    if onset is None:
        return rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused")
    stretch = AbsoluteTimeRange(
        TimeInt(seconds=max(onset - BEFORE_ONSET, 0.0)),
        TimeInt(seconds=onset + AFTER_ONSET),
    )
    return rrb.TimePanel(
        state="collapsed",
        timeline="sim_time",
        play_state="paused",
        loop_mode="selection",
        time_selection=stretch,
    )


def _overview(exhibit: ReportTraces, root: str, title: str, drawn: Drawing | None) -> rrb.Container:
    """The machine three times in one place, the channel that tells most, heat, and the onset."""
    name = exhibit.channels[int(exhibit.telling[0])].name
    told = rrb.Vertical(
        rrb.TimeSeriesView(
            origin="/",
            contents=[f"/{root}/compared/{name}"],
            name=f"{name}, which tells most",
            plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop),
            axis_x=rrb.TimeAxis(link="LinkToGlobal"),
        ),
        rrb.Spatial2DView(origin=f"/{root}/heat/before", name="error before; dark: noise"),
        rrb.Spatial2DView(origin=f"/{root}/heat/after", name="error after"),
        rrb.TextLogView(origin=f"/{root}/events", name="onset: click its time"),
        row_shares=[3, 2, 2, 2],
    )
    if drawn is None:
        return rrb.Vertical(told, name=title)
    centre, size = np.array(drawn.model.stat.center), float(drawn.model.stat.extent)
    eye = rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital,
        position=centre + EYE * size,
        look_target=centre,
        eye_up=(0.0, 0.0, 1.0),
    )
    bodies = rrb.Spatial3DView(
        origin=f"/{root}/bodies",
        name="blue: measured, vermilion: model before, green: with the cause",
        background=rrb.Background(color=BACKGROUND, kind=rrb.BackgroundKind.SolidColor),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=eye,
    )
    return rrb.Horizontal(bodies, told, name=title)


def _tab(title: str, names: list[str], root: str) -> rrb.Container:
    views = [
        rrb.TimeSeriesView(
            origin="/",
            contents=[f"/{root}/{kind}/{name}"],
            name=name if kind == "compared" else f"{name}: residual [sigma]",
            plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop),
            axis_x=rrb.TimeAxis(link="LinkToGlobal"),
        )
        for name in names
        for kind in ("compared", "sigma")
    ]
    return rrb.Grid(*views, grid_columns=2, name=title)
