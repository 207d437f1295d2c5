"""svg: a matplotlib figure as a part of a page, with names of its own for its parts."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, Any

from ves_twin.report.html import Html, markup

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH = 9.6
"""Width of a figure [inch]: that of the page's text."""


def new_figure(height: float, width: float = WIDTH) -> Figure:
    """An empty figure of a size in inches, without a display and without global state."""
    from matplotlib.figure import Figure  # slow to import

    return Figure(figsize=(width, height), layout="constrained")


def svg(figure: Figure, name: str, caption: object) -> Html:
    """A figure as inline SVG with a caption.

    Args:
        figure: drawn; text stays text, so that it can be searched and is small.
        name: of the figure, once a page: it goes before every id, since ids must not repeat.
        caption: what is seen and what it means.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    stream = io.StringIO()
    settings: dict[Any, Any] = {
        "svg.fonttype": "none",
        "svg.hashsalt": name,
        "path.simplify_threshold": 0.3,
    }
    engine = figure.get_layout_engine()
    with mpl.rc_context(settings):
        if engine is not None:  # here at the dots of an SVG: `savefig` would draw all twice for it
            FigureCanvasSVG(figure)
            figure.dpi = 72.0
            engine.execute(figure)
            figure.set_layout_engine(None)
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    drawing = stream.getvalue()
    drawing = drawing[drawing.index("<svg") :]
    drawing = re.sub(r"<metadata>.*?</metadata>", "", drawing, flags=re.DOTALL)
    prefix = re.sub(r"[^A-Za-z0-9]", "_", name)
    for before in ('id="', 'href="#', "url(#"):
        drawing = drawing.replace(before, f"{before}{prefix}-")
    label = re.sub(r"<[^>]*>", "", markup(caption))
    drawing = drawing.replace("<svg ", f'<svg role="img" aria-label="{label}" ', 1)
    return Html(f"<figure>{drawing}<figcaption>{markup(caption)}</figcaption></figure>")
