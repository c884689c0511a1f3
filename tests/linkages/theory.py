"""Legs of the theory's section 2.3 by its own formulas, dyad after dyad by hand: they share nothing with walkgen's placing."""

import numpy as np

BOXES = {
    "odex": ((0.19, 0.24), (0.27, 0.36)),
    "bessonov": ((-np.pi, -0.04), (np.pi, 0.03)),
    "garrec": ((-np.pi,), (np.pi,)),
    "pantograph": ((-0.04, -0.06), (0.03, 0.06)),
}
"""Least and largest drives, where all poses assemble."""


def direction(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def circles(p, r_p, q, r_q, side):
    """The point at distance r_p of p and r_q of q, on the left of p -> q for side 1."""
    span = q - p
    length = np.hypot(*span)
    along = (length**2 + r_p**2 - r_q**2) / (2 * length)
    across = np.sqrt(r_p**2 - along**2)
    x, y = span / length
    return p + along * np.array([x, y]) + side * across * np.array([-y, x])


def angle(vector):
    return np.arctan2(vector[1], vector[0])


def odex(lift, swing):
    a1, w, a2, hip = np.array([0.05, -0.20]), np.array([-0.02, -0.22]), np.array([0.28, -0.34]), np.zeros(2)
    thigh = angle(circles(a1, lift, hip, 0.20, -1))
    bell = angle(circles(a2, swing, w, 0.12, 1) - w) - np.pi / 2
    s2 = circles(w + 0.11 * direction(bell), 0.22, hip, 0.10, 1)
    shank = angle(s2) - np.pi / 2 + np.pi
    return 0.45 * direction(thigh) + 0.60 * direction(shank)


def bessonov(crank, lift):
    pin = np.array([0.25, -0.15]) + 0.06 * direction(crank)
    slide = pin[0] - np.sqrt(0.25**2 - (pin[1] + 0.15) ** 2)
    return np.array([4 * slide, 4 * -0.15 - 3 * lift])


def garrec(crank):
    a = 0.05
    pin = a * direction(crank)
    middle = circles(pin, 2.5 * a, np.array([2 * a, 0.0]), 2.5 * a, 1)
    pivot = np.array([0.10, 0.45])
    return pivot + 3 * (2 * middle - pin - pivot)


def pantograph(lift, reach):
    top = np.array([0.0, lift])
    return top + 4 * (np.array([reach, -0.15]) - top)


FEET = {"odex": odex, "bessonov": bessonov, "garrec": garrec, "pantograph": pantograph}
