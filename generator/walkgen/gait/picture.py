"""A still picture of a walk: the robot on its ground at one instant, its footholds, gait diagram and margin."""

from io import BytesIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.axes3d import Axes3D

from walkgen.gait.drawing import Drawing
from walkgen.gait.walk import Walk

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


def _robot(axes: Axes3D, walk: Walk, drawn: Drawing, frame: int) -> None:
    row, feet = drawn.rows[frame], walk.feet[drawn.rows[frame]]
    axes.plot_surface(*drawn.ground, color="#e8e4da", alpha=0.4, linewidth=0, zorder=0)
    for line, colour, width in (
        (drawn.legs, _GREY, 2.0),
        (drawn.chains, _GREY, 2.5),
        (drawn.platforms, "#333", 3.0),
        (drawn.polygon, _BLUE, 1.2),
    ):
        axes.plot(*line[frame].T, color=colour, lw=width)
    axes.scatter(*walk.holds.point.T, color=_GREEN, s=8, marker="x")
    for down, colour in ((True, _BLUE), (False, _ORANGE)):
        axes.scatter(*feet[walk.stance[row] == down].T, color=colour, s=26, depthshade=False)
    com = walk.com[row]
    axes.plot([com[0]] * 2, [com[1]] * 2, [com[2], feet[:, 2].mean()], "o:", color=_RED, ms=4)
    x, y, z = (np.nanmax(part) - np.nanmin(part) for part in drawn.ground)
    high = np.nanmax(drawn.legs[..., 2]) - np.nanmin(drawn.ground[2])
    axes.set_zlim(np.nanmin(drawn.ground[2]), np.nanmin(drawn.ground[2]) + max(z, high))
    axes.set(xlim=(drawn.ground[0].min(), drawn.ground[0].max()), ylim=(drawn.ground[1].min(), drawn.ground[1].max()))
    axes.set_box_aspect((x, y, max(z, high)), zoom=1.45)
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
    axes.axhline(0.0, color="#333", lw=0.6)
    axes.axvline(now, color=_RED, lw=1)
    axes.set_title("static stability margin (m)", fontsize=9)
    axes.set_xlabel("t (s)", fontsize=8)
