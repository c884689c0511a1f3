"""A cam as files in mm: numbers (CSV), a drawing to look at (SVG)."""

import numpy as np

from walkgen.design.cam import Profile
from walkgen.design.problem import Reals

_COLUMNS = ("angle_deg", "way_mm", "slope_mm_per_rad", "pitch_x_mm", "pitch_y_mm", "edge_x_mm", "edge_y_mm")
_MORE = ("pressure_angle_deg", "curvature_per_m", "force_n", "spring_mm")
_MARGIN = 20.0
"""Around a drawing (mm)."""


def csv(found: Profile) -> str:
    """One row a point of the profile; digits enough to give the same doubles back to 1e-12 of them."""
    ways = np.column_stack([np.rad2deg(found.phi), 1e3 * found.r, 1e3 * found.slopes, 1e3 * found.pitch, 1e3 * found.contact])
    more = np.column_stack([np.rad2deg(found.pressure), found.curvature, found.force, 1e3 * found.lengths])
    rows = (",".join(f"{entry:.13g}" for entry in row) for row in np.hstack([ways, more]))
    return "\n".join([",".join(_COLUMNS + _MORE), *rows]) + "\n"


def svg(found: Profile) -> str:
    """Edge, way of the roller's centre, hip and the roller at both ends, 1 user unit a mm, y upwards."""
    points = 1e3 * np.vstack([found.contact, found.pitch, [[0.0, 0.0]]])
    low, high = points.min(0) - _MARGIN, points.max(0) + _MARGIN
    width, height = high - low
    radius = 1e3 * float(np.linalg.norm(found.contact[0] - found.pitch[0]))
    rollers = "".join(
        f'<circle cx="{x:.4f}" cy="{y:.4f}" r="{radius:.4f}" stroke="#d9772b" fill="none"/>\n' for x, y in 1e3 * found.pitch[[0, -1]]
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.3f}mm" height="{height:.3f}mm" '
        f'viewBox="{low[0]:.3f} {-high[1]:.3f} {width:.3f} {height:.3f}" stroke-width="0.4">\n'
        f'<g transform="scale(1 -1)">\n{_path(found.contact, "edge", "#1f5fa8")}{_path(found.pitch, "pitch", "#8a8f98")}{rollers}'
        '<path id="hip" d="M-5 0H5M0 -5V5" stroke="#333"/>\n</g>\n</svg>\n'
    )


def _path(points: Reals, name: str, colour: str) -> str:
    way = "L".join(f"{x:.5f} {y:.5f}" for x, y in 1e3 * points)
    return f'<path id="{name}" d="M{way}" stroke="{colour}" fill="none"/>\n'
