"""The theory's two cams (7.6, 7.7)."""

import numpy as np

from walkgen.design.cam import profile
from walkgen.model.cam_potential import OnFrame, OnLink, Pull, Weight

G, R = 9.80665, 0.012
FIRST = OnLink(Weight(-G * 2.732), Pull(2500.0, -180.0), G, arm=0.12, reach=0.10, mass=1.3)
SECOND = OnFrame(Weight(-G * 2.72), Pull(1800.0, -134.0), G, anchor=0.30, reach=0.06, masses=(0.1, 0.8, 0.2), centre=0.02)
CASES = {"cam15": (FIRST, (-35, 55), 0.36, 1801), "cam16": (SECOND, (-35, 45), 0.14, 1601)}


def cut(name, points=None, radius=R):
    cam, span, start, usual = CASES[name]
    return cam, profile(cam, np.deg2rad(np.linspace(*span, points or usual)), start, radius)
