"""A figure as SVG: laid out once, and the same as when matplotlib lays it out."""

import io

import matplotlib as mpl
import numpy as np

from ves_twin.report.figure import new_figure, svg


def drawn():
    """Two axes whose labels need room."""
    figure = new_figure(2.0)
    for one in figure.subplots(2, 1, sharex=True):
        one.plot(np.sin(0.1 * np.arange(50)) * 1e-6, label="a line")
        one.set_ylabel("residual, m")
        one.legend()
    return figure


def test_a_figure_is_to_the_last_bit_what_savefig_lays_out():
    figure, stream = drawn(), io.StringIO()
    settings = {"svg.fonttype": "none", "svg.hashsalt": "x", "path.simplify_threshold": 0.3}
    with mpl.rc_context(settings):
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    told = svg(drawn(), "x", "A caption").replace('id="x-', 'id="').replace("#x-", "#")
    body = stream.getvalue().split("</metadata>")[1]
    assert body.strip() in told
