"""The shipped link with two springs (the theory's A2), and changes of its text."""

import re
from pathlib import Path

SPEC = Path(__file__).parents[2] / "specs" / "balanced_leg_two_springs.toml"
TEXT = SPEC.read_text(encoding="utf-8")
WIDE = {"lever": (0.03, 0.30), "anchor": (0.05, 0.45), "tension": (0.0, 150.0), "free": (0.05, 0.35)}
"""The theory's wide bounds."""


def written(folder, text):
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return path


def bounded(text, **bounds):
    """Other bounds of both springs' parameters, by the ends of their names."""
    for key, (low, high) in bounds.items():
        text = re.sub(rf"((?:front|rear)_{key} = .*bounds = )\[[^]]*\]", rf"\g<1>[{low}, {high}]", text)
    return text


def ranged(text, support, transfer, more=""):
    text = text.replace("limits_deg = [-50, 40]", "limits_deg = [-50, 60]")
    return text.replace("{ hip = [-50, 40] }", f"{{ hip = {support} }}\ntransfer_deg = {{ hip = {transfer} }}\n{more}")


def single(text):
    """With the front spring alone."""
    head, _, rest = text.partition('[[leg_designs.link.springs]]\nname = "rear"')
    return re.sub(r"rear_\w+ = .*\n", "", head + rest[rest.index("[balance.stance]") :])
