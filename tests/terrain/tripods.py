"""Robots to settle: the theory's tripod in its bowl, and ones of more legs with moving masses on any ground."""

import numpy as np

_HEAD = """
walkgen = 1
robot = {{ name = "tripod", gravity = [0, 0, -9.81] }}
generate = {{ functions = ["settle", "foot_positions", "com", "friction_share", "normal"], targets = {targets} }}
platforms = [{{ name = "body", mass = 60.0, com = [0.0, 0.0, 0.35], inertia = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0] }}]
legs = [{legs}]
[parameters]
rough = {{ value = 0.2, unit = "1", runtime = true }}
[leg_designs.spoke]
dh = "classic"
joints = [{{ name = "yaw", type = "revolute", a = 0.3, alpha_deg = 0, d = 0.0{link} }}]
"""
BOWL = """
[[terrain]]
name = "bowl"
surface = "implicit"
f = "x**2 + y**2 + z**2 - 1"
domain = { x = [-1, 1], y = [-1, 1] }
mu = "rough"
"""
HEAVY = ", link = { mass = 4.0, com = [-0.1, 0.02, 0.03], inertia = [0.01, 0.01, 0.01, 0.0, 0.0, 0.0] }"


def tripod(ground: str = BOWL, legs: int = 3, link: str = "", targets: str = '["c", "numpy", "casadi"]') -> str:
    """Feet on a circle of 0.3 m, at q = 0 evenly from the x axis on."""
    mounted = ", ".join(
        f'{{ name = "leg_{number}", design = "spoke", platform = "body", mount = {{ rpy_deg = [0, 0, {360 * number / legs}] }} }}'
        for number in range(legs)
    )
    return _HEAD.format(legs=mounted, link=link, targets=targets) + ground


def friction(points: np.ndarray, normals: np.ndarray, N: np.ndarray, load: np.ndarray) -> tuple[np.ndarray, float]:
    """The least tangential forces [3] (N) that balance a load with these normal forces, and what balance lacks."""
    f = N[:, None] * normals
    left = load + np.concatenate([f.sum(axis=0), np.cross(points, f).sum(axis=0)])
    tangents = np.linalg.svd(normals[:, None])[2][:, 1:]
    columns = np.concatenate([tangents, np.cross(points[:, None], tangents)], axis=-1).reshape(6, 6).T
    T = np.linalg.lstsq(columns, -left, rcond=None)[0]
    return np.linalg.norm(T.reshape(3, 2), axis=1), float(np.abs(columns @ T + left).max())
