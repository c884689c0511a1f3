"""A sole's design as a page that needs nothing else: its table, the sole, the foot's acceleration, the moments, the front."""

from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from walkgen.design.page import HEAD
from walkgen.design.sole_picture import COLOURS, JOINTS
from walkgen.design.sole_problem import PEAKS, UNITS
from walkgen.design.sole_report import sole_report
from walkgen.design.sole_search import SoleDesigned

_TITLES = ("the sole", "angular acceleration of the foot", "moments of the joints", "front")
_AXES = (("forward (m)", "up (m)"), ("s", "rad/s^2"), ("s", "N m"))


def sole_page(found: SoleDesigned) -> str:
    """HTML with the library that draws it inside."""
    title = escape(f"{found.roll.spec.robot.name}: sole {found.roll.name}")
    figure = make_subplots(rows=2, cols=2, subplot_titles=_TITLES, vertical_spacing=0.14)
    for colour, words, point in zip(COLOURS, ("as in the spec", "found"), (found.given, found.found), strict=False):
        forward, up = found.roll.outline(point.x).T
        course = point.course
        figure.add_trace(_line(forward, up, words, colour), row=1, col=1)
        figure.add_trace(_line(course.times, course.of("foot_acceleration").values, words, colour, told=False), row=1, col=2)
        for shade, joint in zip(COLOURS[1:], JOINTS, strict=True):
            own = words == "found"
            line = _line(course.times, course.of(f"{joint}_moment").values, f"{joint}, {words}", shade, dash="solid" if own else "dot")
            figure.add_trace(line, row=2, col=1)
    peaks = np.array([[point.peak(name) for name in PEAKS] for point in found.front])
    texts = ["<br>".join(f"{name} = {value:.5g}" for name, value in zip(found.roll.names, point.x, strict=True)) for point in found.front]
    figure.add_trace(go.Scatter(x=peaks[:, 0], y=peaks[:, 1], text=texts, mode="lines+markers", name="front"), row=2, col=2)
    given = [found.given.peak(name) for name in PEAKS]
    figure.add_trace(_dot((given[0], given[1]), "as in the spec", COLOURS[0]), row=2, col=2)
    figure.add_trace(_dot((0.0, 0.0), "ankle", "#333"), row=1, col=1)
    largest = [f"largest {name} ({UNITS[name]})" for name in PEAKS]
    for place, (x, y) in enumerate((*_AXES, (largest[0], largest[1]))):
        figure.update_xaxes(title_text=x, row=place // 2 + 1, col=place % 2 + 1)
        figure.update_yaxes(title_text=y, row=place // 2 + 1, col=place % 2 + 1)
    figure.update_yaxes(scaleanchor="x", row=1, col=1)
    figure.update_layout(template="plotly_white", height=860, margin={"l": 60, "r": 20, "t": 50, "b": 50})
    body: str = figure.to_html(full_html=False, include_plotlyjs=True, div_id="sole")
    return HEAD.format(title=title, table=escape(sole_report(found))) + body + "</body></html>\n"


def _line(x: np.ndarray, y: np.ndarray, name: str, colour: str, *, told: bool = True, dash: str = "solid") -> go.Scatter:
    return go.Scatter(x=x, y=y, name=name, line={"color": colour, "dash": dash, "simplify": False}, showlegend=told)


def _dot(place: tuple[float, float], name: str, colour: str) -> go.Scatter:
    return go.Scatter(
        x=place[:1], y=place[1:], name=name, mode="markers", marker={"color": colour, "size": 9}, showlegend=False, hovertext=name
    )
