"""write_diagnosis_rrd: measured, nominal and fitted channels, and residuals in sigma, laid over."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ves_twin.core.errors import InvalidInputError
from ves_twin.core.types import FloatArray
from ves_twin.core.whole_file import whole_file
from ves_twin.diagnosis.report_traces import ReportTraces, Traces
from ves_twin.diagnosis.verdict import Verdict
from ves_twin.report.colours import AFTER, BEFORE, MEASURED, TOLERANCES, Colour, rgb
from ves_twin.report.diagnosis.answer import (
    confidence_sentence,
    nearest_sentence,
    next_step,
    verdict_sentence,
)
from ves_twin.report.diagnosis.basis import basis_sentences, gain_sentence
from ves_twin.report.diagnosis.words import fitted_word
from ves_twin.report.rerun.series import shown


def write_diagnosis_rrd(verdict: Verdict, path: Path) -> Path:
    """Write a verdict's traces as a rerun file, for the viewer of the same release.

    The timeline is `sim_time` [s]. Entities of recording n are rn/compared/CHANNEL (measured,
    nominal, fitted) and rn/sigma/CHANNEL (before, after); `verdict` is the text.

    Args:
        verdict: from `diagnose`, with its traces.
        path: the .rrd file; one that exists is replaced.

    Raises:
        InvalidInputError: a verdict without traces, as from a file.
        FileAccessError: the file cannot be written.
    """
    if verdict.exhibit is None:
        raise InvalidInputError("verdict", "no traces", "one that diagnose has just returned")
    with whole_file(path) as partial:
        _write(verdict, verdict.exhibit, partial)
    return path


def _write(verdict: Verdict, exhibit: ReportTraces, path: Path) -> None:
    stream = rr.RecordingStream("ves_twin diagnosis")
    content = stream.binary_stream()  # see write.py
    stream.send_blueprint(diagnosis_blueprint(exhibit), make_active=True, make_default=True)
    stream.send_recording_name(f"diagnosis: {verdict.verdict.value}")
    page = rr.TextDocument(_account(verdict), media_type=rr.MediaType.MARKDOWN)
    stream.log("verdict", page, static=True)
    for number, traces in enumerate(exhibit.traces, 1):
        for c in range(len(exhibit.channels)):
            _send_channel(stream, exhibit, traces, c, f"r{number}", fitted_word(verdict))
    path.write_bytes(content.read() or b"")
    stream.disconnect()


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


def diagnosis_blueprint(exhibit: ReportTraces) -> rrb.Blueprint:
    """A tab for each signal of each recording: every channel, and its residual in sigma beside."""
    several = len(exhibit.traces) > 1
    signals = list(dict.fromkeys(channel.signal for channel in exhibit.channels))
    tabs = []
    for number, traces in enumerate(exhibit.traces, 1):
        for signal in signals:
            names = [c.name for c in exhibit.channels if c.signal == signal]
            title = f"{traces.name}: {signal}" if several else signal
            tabs.append(_tab(title, names, f"r{number}"))
    text = rrb.TextDocumentView(origin="/verdict", name="Verdict")
    return rrb.Blueprint(
        rrb.Horizontal(rrb.Tabs(*tabs, active_tab=0), text, column_shares=[4, 1]),
        rrb.TopPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
        auto_layout=False,
        auto_views=False,
    )


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
