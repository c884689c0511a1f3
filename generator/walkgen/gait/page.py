"""A walk as one page that needs nothing else: the moving robot in three dimensions, its gait diagram, margin and joints."""

from collections.abc import Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from walkgen.gait.drawing import Drawing
from walkgen.gait.walk import Walk

_BLUE, _ORANGE, _GREY, _GREEN, _RED = "#1f5fa8", "#d9772b", "#8a8f98", "#2e8b57", "#c0392b"
_FRAME_MS = 40
_FOLLOW = """
var robot = document.getElementById('{plot_id}');
var curves = document.getElementById('curves');
robot.on('plotly_animatingframe', function (event) {
  document.documentElement.setAttribute('data-instant', event.name);
  if (curves && curves.layout) {
    Plotly.relayout(curves, {'shapes[0].x0': Number(event.name), 'shapes[0].x1': Number(event.name)});
  }
});
"""
_CAMERA = {"eye": {"x": 1.0, "y": -2.0, "z": 0.9}, "center": {"x": 0.0, "y": 0.0, "z": -0.1}}
"""From the right, so far away that a long walk is in sight."""
_HEAD = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="generator" content="walkgen"><title>{title}</title>
<link rel="icon" href="data:,">
<style>body {{ font: 15px/1.5 system-ui, sans-serif; margin: 1.5em auto; max-width: 72em; color: #222 }} h1 {{ font-size: 1.3em }}
.bad {{ color: #c0392b }} .good {{ color: #2e8b57 }}</style></head><body>
<h1>{title}</h1>
{summary}
"""


def page(walk: Walk, drawn: Drawing, units: Sequence[str] = ()) -> str:
    """HTML with the library that draws it inside.

    While the animation runs the root element's attribute `data-instant` holds the instant shown (s).

    Args:
        walk: simulated.
        drawn: its lines at the animation's instants.
        units: of the joints, rad or m; rad where left out.
    """
    title = escape(f"{walk.robot}: {len(walk.legs)} legs, {walk.times[-1]:.4g} s")
    robot: str = _animation(walk, drawn).to_html(
        full_html=False, include_plotlyjs=True, div_id="robot", post_script=_FOLLOW, auto_play=True, animation_opts=_playing()
    )
    curves: str = _curves(walk, units or ("rad",) * len(walk.joints)).to_html(full_html=False, include_plotlyjs=False, div_id="curves")
    return _HEAD.format(title=title, summary=_summary(walk)) + robot + curves + "</body></html>\n"


def _summary(walk: Walk) -> str:
    feet = walk.trajectory
    pace = f"{feet.summary.capitalize()}, {feet.speed:.4g} m/s. {walk.margin_summary.capitalize()}."
    if walk.feasible:
        return f'<p class="good">Feasible. {escape(pace)}</p>'
    items = "".join(f"<li>{escape(str(fault))}</li>" for fault in walk.faults)
    return f'<p class="bad">Not feasible. {escape(pace)}</p><ul class="bad">{items}</ul>'


def _playing() -> dict[str, object]:
    return {"frame": {"duration": _FRAME_MS, "redraw": True}, "transition": {"duration": 0}, "fromcurrent": True, "mode": "immediate"}


def _line(points: np.ndarray, **style: object) -> go.Scatter3d:
    x, y, z = np.round(points, 5).T
    return go.Scatter3d(x=x, y=y, z=z, hoverinfo="skip", **style)


def _moving(walk: Walk, drawn: Drawing, frame: int) -> list[go.Scatter3d]:
    """What changes from frame to frame, always in this order."""
    row = drawn.rows[frame]
    com = walk.com[row]
    feet = np.nan_to_num(walk.feet[row])
    colours = [_BLUE if down else _ORANGE for down in walk.stance[row]]
    chained = bool(np.isfinite(drawn.chains[frame]).any())
    below = np.array([com, [com[0], com[1], feet[:, 2].mean()]])
    return [
        _line(drawn.platforms[frame], mode="lines", line={"color": "#333", "width": 8}, name="platforms"),
        _line(
            drawn.chains[frame],
            mode="lines+markers",
            line={"color": _GREY, "width": 7},
            marker={"size": 3},
            name="chains",
            showlegend=chained,
        ),
        _line(drawn.legs[frame], mode="lines+markers", line={"color": _GREY, "width": 5}, marker={"size": 3, "color": "#333"}, name="legs"),
        _line(drawn.soles[frame], mode="lines", line={"color": _GREY, "width": 3}, name="soles"),
        _line(feet, mode="markers", marker={"size": 6, "color": colours}, name="feet"),
        _line(drawn.polygon[frame], mode="lines", line={"color": _BLUE, "width": 3}, name="support polygon"),
        _line(
            below,
            mode="lines+markers",
            line={"color": _RED, "width": 2, "dash": "dot"},
            marker={"size": [6, 4], "color": _RED},
            name="centre of mass",
        ),
    ]


def _animation(walk: Walk, drawn: Drawing) -> go.Figure:
    moving = _moving(walk, drawn, 0)
    x, y, z = (np.round(part, 4) for part in drawn.ground)
    still = [
        go.Surface(
            x=x, y=y, z=z, showscale=False, opacity=0.55, colorscale=[[0, "#cfc8b8"], [1, "#e8e4da"]], hoverinfo="skip", name="ground"
        ),
        _line(walk.holds.point, mode="markers", marker={"size": 3, "color": _GREEN}, name="footholds"),
        _line(walk.com, mode="lines", line={"color": _RED, "width": 1}, name="way of the centre of mass"),
    ]
    names = [f"{at:.4g}" for at in drawn.times]
    places = list(range(len(moving)))
    frames = [go.Frame(data=_moving(walk, drawn, number), name=name, traces=places) for number, name in enumerate(names)]
    figure = go.Figure(data=[*moving, *still], frames=frames)
    figure.update_layout(
        height=650,
        margin={"l": 0, "r": 0, "t": 0, "b": 110},
        scene={"aspectmode": "data", "camera": _CAMERA, "xaxis_title": "x (m)", "yaxis_title": "y (m)", "zaxis_title": "z (m)"},
        legend={"x": 0.0, "y": 1.0, "bgcolor": "rgba(255, 255, 255, 0.7)"},
        updatemenus=[_buttons()],
        sliders=[_slider(names)],
    )
    return figure


def _buttons() -> dict[str, object]:
    still = {"frame": {"duration": 0, "redraw": False}, "mode": "immediate"}
    play = {"label": "Play", "method": "animate", "args": [None, _playing()]}
    return {
        "type": "buttons",
        "direction": "left",
        "x": 0.0,
        "y": 0.0,
        "buttons": [play, {"label": "Pause", "method": "animate", "args": [[None], still]}],
    }


def _slider(names: Sequence[str]) -> dict[str, object]:
    at_once = {"frame": {"duration": 0, "redraw": True}, "mode": "immediate"}
    steps = [{"label": name, "method": "animate", "args": [[name], at_once]} for name in names]
    return {"x": 0.18, "len": 0.8, "y": 0.0, "currentvalue": {"prefix": "t = ", "suffix": " s"}, "steps": steps}


def _curves(walk: Walk, units: Sequence[str]) -> go.Figure:
    titles = ("Gait diagram: bars are supports", "Stability margin (m): static, with inertia dotted", "Joints")
    figure = make_subplots(rows=3, cols=1, shared_xaxes=True, subplot_titles=titles, vertical_spacing=0.06, row_heights=[0.3, 0.25, 0.45])
    for leg, start, length in _bars(walk):
        figure.add_bar(x=[length], base=[start], y=[leg], orientation="h", marker_color=_BLUE, showlegend=False, row=1, col=1)
    figure.add_scatter(x=walk.times, y=np.round(walk.margins.static, 6), mode="lines", line_color=_GREEN, showlegend=False, row=2, col=1)
    inertia = {"line_color": _GREEN, "line_dash": "dot", "showlegend": False}
    figure.add_scatter(x=walk.times, y=np.round(walk.margins.dynamic, 6), mode="lines", row=2, col=1, **inertia)
    for number, (joint, unit) in enumerate(zip(walk.joints, units, strict=True)):
        figure.add_scatter(x=walk.times, y=np.round(walk.q[:, number], 5), mode="lines", name=f"{joint} ({unit})", row=3, col=1)
    figure.update_yaxes(autorange="reversed", row=1, col=1)
    figure.update_xaxes(title_text="t (s)", range=[0.0, float(walk.times[-1])], row=3, col=1)
    figure.update_layout(height=900, barmode="overlay", margin={"l": 90, "r": 10, "t": 40, "b": 40}, legend={"y": 0.35})
    marker = {"type": "line", "xref": "x", "yref": "paper", "x0": 0, "x1": 0, "y0": 0, "y1": 1, "line": {"color": _RED, "width": 1}}
    figure.update_layout(shapes=[marker])
    return figure


def _bars(walk: Walk) -> list[tuple[str, float, float]]:
    """Leg, start and length (s) of every support within the walk, as it was walked."""
    found = []
    for foot, leg in enumerate(walk.legs):
        edges = np.flatnonzero(np.diff(walk.stance[:, foot].astype(int), prepend=0, append=0))
        for start, end in zip(edges[::2], edges[1::2], strict=True):
            first, last = walk.times[start], walk.times[min(end, len(walk.times) - 1)]
            found.append((leg, float(first), float(last - first)))
    return found
