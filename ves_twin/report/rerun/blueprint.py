"""blueprint_of: the layout of a recording's views: 3-D, tabs of plots, events, account."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import rerun.blueprint as rrb

from ves_twin.core.signals import SIGNALS
from ves_twin.report.rerun.colours import BACKGROUND

EYE = (2.4, -2.3, 2.0)
LOOK_AT = (0.0, 0.0, 1.05)
"""Camera and the point it looks at [m], inertial frame: the whole rig from its front corner."""


@dataclass(frozen=True)
class Plot:
    """One plot: title with unit, and the entities whose lines it holds."""

    title: str
    entities: tuple[str, ...]
    legend: bool = True


@dataclass(frozen=True)
class Page:
    """One tab of plots in a number of columns."""

    title: str
    columns: int
    plots: tuple[Plot, ...]


def _axis_plots(axes: tuple[str, ...], unit: str) -> tuple[Plot, ...]:
    # the colours mean the same on all six axes: one legend, so that the lines stay in sight
    return tuple(
        Plot(f"{axis} [{unit}]", (f"base_motion/{axis}",), legend=axis == "x") for axis in axes
    )


def _interleaved(left: Iterable[Plot], right: Iterable[Plot]) -> tuple[Plot, ...]:
    return tuple(plot for pair in zip(left, right, strict=True) for plot in pair)


_PAGES = (
    Page(
        "Base motion",
        2,
        _interleaved(
            (
                *_axis_plots(("x", "y", "z"), "mm"),
                Plot("Position error [mm]", ("base_motion/error/position",)),
            ),
            (
                *_axis_plots(("rx", "ry", "rz"), "mrad"),
                Plot("Angle error [mrad]", ("base_motion/error/angles",)),
            ),
        ),
    ),
    Page(
        "Legs",
        2,
        (
            Plot("Leg command [mm]", ("signals/leg.command",)),
            Plot("Leg length [mm]", ("signals/leg.length",), legend=False),
            Plot("Leg error: command less length [mm]", ("legs/error",), legend=False),
            Plot("Valve command [-]", ("signals/valve.command",), legend=False),
        ),
    ),
    Page(
        "Wrench",
        2,
        (
            Plot(
                "Force and gravity estimate [N]",
                ("signals/sensor.wrench/force", "signals/gravity.estimate/force"),
            ),
            Plot(
                "Moment and gravity estimate [N*m]",
                ("signals/sensor.wrench/moment", "signals/gravity.estimate/moment"),
            ),
            Plot("Dynamic force: sensor less gravity [N]", ("dynamic_wrench/force",)),
            Plot("Dynamic moment: sensor less gravity [N*m]", ("dynamic_wrench/moment",)),
        ),
    ),
    Page(
        "Arm",
        1,
        (
            Plot("Joint angle and command [rad]", ("signals/arm.q", "signals/arm.command")),
            Plot("Servo error: command less angle [mrad]", ("arm/error",)),
            Plot("Joint torque [N*m]", ("signals/arm.torque",)),
        ),
    ),
    Page(
        "Platform",
        2,
        (
            Plot("Commanded position [mm]", ("signals/platform.command/position",)),
            Plot("Commanded angles [mrad]", ("signals/platform.command/angles",)),
            Plot("Position from leg lengths [mm]", ("signals/platform.pose/position",)),
            Plot("Angles from leg lengths [mrad]", ("signals/platform.pose/angles",)),
            Plot("Reference with leg lag [mm]", ("signals/reference.pose_leg_lag/position",)),
            Plot("Reference with leg lag [mrad]", ("signals/reference.pose_leg_lag/angles",)),
        ),
    ),
    Page(
        "Truth",
        2,
        (
            Plot("True force at the sensor [N]", ("signals/truth.wrench/force",)),
            Plot("True moment at the sensor [N*m]", ("signals/truth.wrench/moment",)),
            Plot("Cylinder force [N]", ("signals/truth.leg_force",)),
            Plot("Leg bending [mrad]", ("signals/truth.leg_bending",), legend=False),
            Plot("Supply pressure [bar]", ("signals/supply.pressure",)),
        ),
    ),
)


def blueprint_of(entities: frozenset[str]) -> rrb.Blueprint:
    """Layout for the plotted entities that a recording has; pages without one are left out.

    Signals that are not of the rig's table have a page of their own, one plot an entity.
    """
    wanted = (*_PAGES, _own_signals(entities))
    pages = [page for page in (_page(p, entities) for p in wanted) if page is not None]
    upper = rrb.Horizontal(_machine(), rrb.Tabs(*pages, active_tab=0), column_shares=[5, 6])
    lower = rrb.Horizontal(_events(), _account(), column_shares=[5, 6])
    return rrb.Blueprint(
        rrb.Vertical(upper, lower, row_shares=[9, 4]),
        rrb.TopPanel(state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="sim_time", play_state="paused"),
        auto_layout=False,
        auto_views=False,
    )


def _own_signals(entities: frozenset[str]) -> Page:
    found = (e.removeprefix("signals/") for e in sorted(entities) if e.startswith("signals/"))
    own = [name for name in found if name.split("/")[0] not in SIGNALS]
    return Page("Other signals", 2, tuple(Plot(name, (f"signals/{name}",)) for name in own))


def _machine() -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        origin="/",
        contents=["/machine/**", "/ghost/**"],
        name="Rig and zero-g reference",
        background=rrb.Background(color=BACKGROUND, kind=rrb.BackgroundKind.SolidColor),
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=EYE, look_target=LOOK_AT, eye_up=(0.0, 0.0, 1.0)
        ),
    )


def _events() -> rrb.TextLogView:
    return rrb.TextLogView(
        origin="/events",
        name="Events",
        columns=rrb.TextLogColumns(
            timeline_columns=["sim_time"], text_log_columns=["LogLevel", "Body"]
        ),
    )


def _account() -> rrb.TextDocumentView:
    return rrb.TextDocumentView(origin="/account", name="Account of the run")


def _page(page: Page, entities: frozenset[str]) -> rrb.Container | None:
    found = [p for p in page.plots if entities & set(p.entities)]
    if not found:
        return None
    views = [_plot(p, entities) for p in found]
    return rrb.Grid(*views, grid_columns=page.columns, name=page.title)


def _plot(plot: Plot, entities: frozenset[str]) -> rrb.TimeSeriesView:
    return rrb.TimeSeriesView(
        origin="/",
        contents=[f"/{entity}" for entity in plot.entities if entity in entities],
        name=plot.title,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop, visible=plot.legend),
        axis_x=rrb.TimeAxis(link="LinkToGlobal"),
    )
