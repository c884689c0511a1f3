"""A sole's design as a picture: the sole, the foot's acceleration, the moments of the joints, the front."""

from io import BytesIO

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from walkgen.design.sole_problem import PEAKS, UNITS
from walkgen.design.sole_search import SoleDesigned

JOINTS = ("hip", "knee", "ankle")
COLOURS = ("#8a8f98", "#1f5fa8", "#d9772b", "#2a8a57")


def sole_picture(found: SoleDesigned) -> bytes:
    """PNG."""
    figure = Figure(figsize=(11, 7.5), dpi=90, layout="constrained")
    (sole, turning), (moments, front) = figure.subplots(2, 2)
    _sole(sole, found)
    _turning(turning, found)
    _moments(moments, found)
    _front(front, found)
    for axes in (sole, turning, moments, front):
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    out = BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()


def _sole(axes: Axes, found: SoleDesigned) -> None:
    for colour, words, point in zip(COLOURS, ("as in the spec", "found"), (found.given, found.found), strict=False):
        forward, up = found.roll.outline(point.x).T
        axes.plot(forward, up, color=colour, label=words)
    axes.plot(0.0, 0.0, "o", color="#333", label="ankle")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("forward (m)")
    axes.set_ylabel("up (m)")


def _turning(axes: Axes, found: SoleDesigned) -> None:
    for colour, words, point in zip(COLOURS, ("as in the spec", "found"), (found.given, found.found), strict=False):
        axes.plot(point.course.times, point.course.of("foot_acceleration").values, color=colour, label=words)
    axes.set_xlabel("s")
    axes.set_ylabel("angular acceleration of the foot (rad/s$^2$)")


def _moments(axes: Axes, found: SoleDesigned) -> None:
    for colour, joint in zip(COLOURS[1:], JOINTS, strict=True):
        for style, point in (("--", found.given), ("-", found.found)):
            label = joint if style == "-" else f"{joint}, as in the spec"
            axes.plot(point.course.times, point.course.of(f"{joint}_moment").values, style, color=colour, label=label)
    axes.set_xlabel("s")
    axes.set_ylabel("N m")


def _front(axes: Axes, found: SoleDesigned) -> None:
    peaks = np.array([[point.peak(name) for name in PEAKS] for point in found.front])
    axes.plot(*peaks.T, "o-", color=COLOURS[1], label="front")
    axes.plot(*[[found.given.peak(name)] for name in PEAKS], "s", color=COLOURS[0], label="as in the spec")
    first, second = PEAKS
    axes.set_xlabel(f"largest {first} ({UNITS[first]})")
    axes.set_ylabel(f"largest ankle {second} ({UNITS[second]})")
