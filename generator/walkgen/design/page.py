"""What a balance leaves, as a page that needs nothing else."""

from html import escape

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from walkgen.design.cam_files import svg
from walkgen.design.cam_search import CamDesigned
from walkgen.design.report import columns, report
from walkgen.design.search import Designed

_COLOURS = ("#8a8f98", "#1f5fa8", "#d9772b")
HEAD = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="generator" content="walkgen"><title>{title}</title><link rel="icon" href="data:,">
<style>body {{ font: 15px/1.5 system-ui, sans-serif; margin: 1.5em auto; max-width: 72em; color: #222 }} h1 {{ font-size: 1.3em }}</style>
</head><body><h1>{title}</h1><pre>{table}</pre>
"""
"""Of a page of a design, with its `title` and its `table`."""


def page(found: Designed | CamDesigned) -> str:
    """HTML with the library that draws it inside: the table, a cam, and every moment over its range."""
    title = escape(f"{found.balance.spec.robot.name}: balance {found.balance.name}")
    names = [f"{residue.range.phase}: {residue.range.name}" for residue in found.after]
    figure = make_subplots(rows=len(names), cols=1, subplot_titles=names)
    for colour, (words, residues) in zip(_COLOURS, columns(found), strict=False):
        for row, residue in enumerate(residues, 1):
            turns = residue.range.unit == "rad"
            x = np.rad2deg(residue.values) if turns else residue.values
            line = go.Scatter(x=x, y=residue.moments, name=words, line={"color": colour}, legendgroup=words, showlegend=row == 1)
            figure.add_trace(line, row=row, col=1)
            figure.update_xaxes(title_text=f"{residue.range.name} ({'deg' if turns else 'm'})", row=row, col=1)
            figure.update_yaxes(title_text="N m" if turns else "N", row=row, col=1)
    figure.update_layout(template="plotly_white", height=80 + 320 * len(names), margin={"l": 60, "r": 20, "t": 50, "b": 50})
    body: str = figure.to_html(full_html=False, include_plotlyjs=True, div_id="balance")
    drawn = svg(found.profile) if isinstance(found, CamDesigned) else ""
    return HEAD.format(title=title, table=escape(report(found))) + drawn + body + "</body></html>\n"
