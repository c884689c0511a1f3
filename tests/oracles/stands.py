"""Oracle numbers typed by hand from the theory of elastic stands (O12-O14): joint values, loads and what must come out."""

import numpy as np

# O12: the front left leg
O12_Q = np.array([0.1, 0.5, -1.6])
O12_FOOT = np.array([0.2932354834962705, 0.7657517518509034, -0.18868400551310313])
O12_AXIAL = (
    1.3385601184273687e-4,
    1.118454994634601e-5,
    -1.8901727718863274e-6,
    2.3505777644612827e-5,
    1.8838679915917433e-5,
    2.350616419416691e-5,
)
O12_PLAIN = (
    1.3385579684532177e-4,
    1.1186692749134167e-5,
    -1.8906257850245678e-6,
    2.3484421091154097e-5,
    1.884319493678534e-5,
    2.34796405069455e-5,
)

# O13: front left, front right, rear left, rear right
O13_Q = np.array([0.1, 0.5, -1.6, -0.1, 0.45, -1.7, 0.05, 0.55, -1.65, -0.2, 0.4, -1.75])
O13_WRENCH = np.array([12.0, -5.0, -588.6, 3.0, -4.0, 2.0])
O13_F = np.array(
    [
        [0.16676658517193133, -118.15211305301915, 161.53312663870892],
        [-3.0460854676212357, 119.2303640955065, 180.18825845001155],
        [-8.542533860976869, -70.63700126400516, 110.63417843161764],
        [-0.578147256573784, 74.55875022151784, 136.24443647966194],
    ]
)
O13_DELTA = np.array(
    [
        0.0018603599617514675,
        -0.000268417962858812,
        -0.0011762152938380956,
        -0.00033616856358631555,
        0.0004680271935548521,
        0.00021883031718729687,
    ]
)

# O14: all legs alike under weight alone
O14_Q = np.tile([0.0, 0.45, -1.75], 4)
O14_WRENCH = np.array([0.0, 0.0, -588.6, 0.0, 0.0, 0.0])
O14_F = np.array([[0.0, side * 84.358918, 147.15] for side in (-1, 1, -1, 1)])
O14_PLAIN = 84.420
"""Sideways, without the links' stretch."""


def symmetric(upper) -> np.ndarray:
    """xx xy xz yy yz zz as a matrix."""
    xx, xy, xz, yy, yz, zz = upper
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
