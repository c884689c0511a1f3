"""Specs of a small robot on some ground, and the ground's own geometry by central differences: what every test of terrain stands on."""

from collections.abc import Callable, Sequence

import numpy as np

TERRAIN = ("height", "normal", "tangents", "curvature", "ground", "compliance", "patch", "project")

_ROBOT = """
walkgen = 1
[robot]
name = "rob"
gravity = {gravity}
[generate]
functions = [{functions}]
targets = {targets}
[parameters]
{parameters}
[leg_designs.l]
dh = "classic"
joints = [{{ name = "a", type = "revolute", a = 0.1, alpha_deg = 90, d = 0.0 }}]
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "l"
platform = "body"
"""


def spec(
    *patches: str,
    gravity: Sequence[float] = (0.0, 0.0, -9.80665),
    parameters: str = "",
    functions: Sequence[str] = TERRAIN,
    casadi: bool = False,
) -> str:
    """A one-legged robot with these patches, each the keys of its table."""
    names = ", ".join(f'"{name}"' for name in functions)
    head = _ROBOT.format(
        gravity=list(map(float, gravity)),
        functions=names,
        parameters=parameters,
        targets='["c", "numpy", "casadi"]' if casadi else '["c", "numpy"]',
    )
    tables = (f'[[terrain]]\nname = "patch{index}"\n{patch}\n' for index, patch in enumerate(patches))
    return head + "".join(tables)


def explicit(height: str, more: str = "") -> str:
    """The keys of an explicit patch."""
    return f'surface = "explicit"\nheight = "{height}"\n{more}'


def slopes(f: Callable[[np.ndarray], np.ndarray], at: np.ndarray, step: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """Gradient [..., 2] and second derivatives [..., 2, 2] of a height over (x, y), to fourth and second order in the step."""
    axes = np.eye(2) * step
    near = [(f(at + a) - f(at - a)) / (2 * step) for a in axes]
    far = [(f(at + 2 * a) - f(at - 2 * a)) / (4 * step) for a in axes]
    first = np.stack([(4 * n - w) / 3 for n, w in zip(near, far, strict=True)], -1)
    second = np.empty((*first.shape, 2))
    for i in range(2):
        for j in range(2):
            a, b = axes[i], axes[j]
            second[..., i, j] = (f(at + a + b) - f(at + a - b) - f(at - a + b) + f(at - a - b)) / (4 * step**2)
    return first, second


def weingarten(first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gaussian and mean curvature of a height by the textbook's formulas (positive in a hollow), from its derivatives."""
    fx, fy = first[..., 0], first[..., 1]
    fxx, fxy, fyy = second[..., 0, 0], second[..., 0, 1], second[..., 1, 1]
    w = 1 + fx**2 + fy**2
    gauss = (fxx * fyy - fxy**2) / w**2
    mean = ((1 + fy**2) * fxx - 2 * fx * fy * fxy + (1 + fx**2) * fyy) / (2 * w**1.5)
    return gauss, mean
