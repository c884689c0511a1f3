"""A still picture of a walk: the robot on its ground at one instant, its footholds, gait diagram and margin."""

from io import BytesIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D

from walkgen.gait.drawing import Drawing
from walkgen.gait.walk import Walk

_AROUND = 0.45
_FEWEST = 5
_BLUE, _ORANGE, _GREY, _GREEN, _RED = "#1f5fa8", "#d9772b", "#8a8f98", "#2e8b57", "#c0392b"


def picture(walk: Walk, drawn: Drawing, frame: int) -> bytes:
    """PNG of one of the drawing's frames.

    Args:
        walk: simulated.
        drawn: its lines.
        frame: which.
    """
    figure = Figure(figsize=(11, 4.4), dpi=80)
    grid = figure.add_gridspec(2, 2, width_ratios=[2.4, 1], left=0.0, right=0.98, top=0.93, bottom=0.11, wspace=0.18, hspace=0.35)
    _robot(figure.add_subplot(grid[:, 0], projection="3d"), walk, drawn, frame)
    _diagram(figure.add_subplot(grid[0, 1]), walk, float(drawn.times[frame]))
    _margin(figure.add_subplot(grid[1, 1]), walk, float(drawn.times[frame]))
    out = BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()


def _nearby(drawn: Drawing, frame: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, y and z of the ground's mesh about the robot; of all of it where little is there."""
    x, y, z = drawn.ground
    low, high = np.nanmin(drawn.legs[frame], axis=0) - _AROUND, np.nanmax(drawn.legs[frame], axis=0) + _AROUND
    columns, rows = np.flatnonzero((x[0] >= low[0]) & (x[0] <= high[0])), np.flatnonzero((y[:, 0] >= low[1]) & (y[:, 0] <= high[1]))
    if min(len(columns), len(rows)) < _FEWEST:
        return x, y, z
    place = np.ix_(rows, columns)
    return x[place], y[place], z[place]


def _robot(axes: Axes3D, walk: Walk, drawn: Drawing, frame: int) -> None:
    row, feet = drawn.rows[frame], walk.feet[drawn.rows[frame]]
    ground = _nearby(drawn, frame)
    axes.computed_zorder = False  # the robot stands on the ground, so it is drawn over it
    axes.plot_surface(*ground, color="#efe9da", edgecolor="#c2b89e", linewidth=0.35, alpha=0.6, rcount=41, ccount=41, zorder=0)
    for line, colour, width in (
        (drawn.legs, _GREY, 2.0),
        (drawn.soles, _GREY, 1.0),
        (drawn.chains, _GREY, 2.5),
        (drawn.platforms, "#333", 3.0),
        (drawn.polygon, _BLUE, 1.2),
    ):
        axes.plot(*line[frame].T, color=colour, lw=width)
    x, y, _ = walk.holds.point.T
    seen = (x >= ground[0].min()) & (x <= ground[0].max()) & (y >= ground[1].min()) & (y <= ground[1].max())
    axes.scatter(*walk.holds.point[seen].T, color=_GREEN, s=10, marker="x")
    for down, colour in ((True, _BLUE), (False, _ORANGE)):
        axes.scatter(*feet[walk.stance[row] == down].T, color=colour, s=26, depthshade=False)
    com = walk.com[row]
    axes.plot([com[0]] * 2, [com[1]] * 2, [com[2], feet[:, 2].mean()], "o:", color=_RED, ms=4)
    long, wide, tall = (np.nanmax(part) - np.nanmin(part) for part in ground)
    tall = max(tall, np.nanmax(drawn.legs[frame, :, 2]) - np.nanmin(ground[2]))
    axes.set_zlim(np.nanmin(ground[2]), np.nanmin(ground[2]) + tall)
    axes.set(xlim=(ground[0].min(), ground[0].max()), ylim=(ground[1].min(), ground[1].max()))
    axes.set_box_aspect((long, wide, tall), zoom=1.45)
    axes.set(xlabel="x (m)", ylabel="y (m)")
    axes.locator_params(axis="z", nbins=3)
    axes.view_init(elev=24, azim=-58)


def _diagram(axes: Axes, walk: Walk, now: float) -> None:
    """Hildebrand's bars."""
    for foot in range(len(walk.legs)):
        edges = np.flatnonzero(np.diff(walk.stance[:, foot].astype(int), prepend=0, append=0))
        ends = walk.times[np.minimum(edges, len(walk.times) - 1)]
        axes.broken_barh([(start, end - start) for start, end in zip(ends[::2], ends[1::2], strict=True)], (foot - 0.35, 0.7), color=_BLUE)
    axes.set_yticks(range(len(walk.legs)), walk.legs, fontsize=7)
    axes.invert_yaxis()
    axes.axvline(now, color=_RED, lw=1)
    axes.set_title("supports", fontsize=9)


def _margin(axes: Axes, walk: Walk, now: float) -> None:
    axes.plot(walk.times, walk.margins.static, color=_GREEN)
    axes.plot(walk.times, walk.margins.dynamic, ":", color=_GREEN)
    axes.axhline(0.0, color="#333", lw=0.6)
    axes.axvline(now, color=_RED, lw=1)
    axes.set_title("stability margin (m): static, with inertia dotted", fontsize=9)
    axes.set_xlabel("t (s)", fontsize=8)
