"""What a balance leaves, as a picture."""

from io import BytesIO

import numpy as np
from matplotlib.figure import Figure

from walkgen.design.cam_search import CamDesigned
from walkgen.design.report import columns
from walkgen.design.search import Designed

_COLOURS = ("#8a8f98", "#1f5fa8", "#d9772b")


def picture(found: Designed | CamDesigned) -> bytes:
    """PNG of every moment over its range."""
    count = len(found.after)
    figure = Figure(figsize=(8, 1 + 2.6 * count), dpi=90, layout="constrained")
    axes = figure.subplots(count, 1, squeeze=False)[:, 0]
    for colour, (words, residues) in zip(_COLOURS, columns(found), strict=False):
        for axis, residue in zip(axes, residues, strict=True):
            turns = residue.range.unit == "rad"
            axis.plot(np.rad2deg(residue.values) if turns else residue.values, residue.moments, color=colour, label=words)
            axis.set_title(f"{residue.range.phase}: {residue.range.name}", fontsize=10)
            axis.set_xlabel("deg" if turns else "m")
            axis.set_ylabel("N m" if turns else "N")
            axis.grid(alpha=0.3)
    axes[0].legend(fontsize=8)
    out = BytesIO()
    figure.savefig(out, format="png", metadata={"Software": None})
    return out.getvalue()
