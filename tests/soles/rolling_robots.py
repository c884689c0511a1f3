"""Robots with one leg that rolls on a curved sole, as text, and all outputs of their functions in every backend."""

import re
from pathlib import Path

import numpy as np
import pytest

SPECS = Path(__file__).parents[2] / "specs"
LEG = (SPECS / "anthropomorphic_leg.toml").read_text(encoding="utf-8")
BACKENDS = ["c", "numpy", "casadi"]
STANCE = (
    *("link_angles", "joint_angles", "flat_ankle", "flat_position", "flat_motion", "stance_position", "hip_position"),
    *("toe_rolling", "toe_motion", "heel_rolling", "heel_motion"),
)
FORCES = tuple(f"stance_forces{mode}" for mode in ("", "_passive", "_pressure", "_load", "_ankle", "_rolling", "_sliding"))
MASSES, INERTIAS = (8.0, 4.0, 1.2), (0.13, 0.07, 0.006)
CENTRES = np.array([(0.18, 0.01), (0.20, -0.005), (0.05, 0.03)])
THIGH = SHANK = 0.42
DEPTH, REAR, FRONT, GRAVITY = 0.09, -0.06, 0.12, 9.80665
CURVES = {
    "ellipse": "toe = { ellipse = [0.09, 0.06], end_deg = 75 }",
    "expressions": 'toe = { x = "0.09 - 0.06*(1 - cos(lambda))", y = "0.12 + 0.09*sin(lambda)", end = 1.3 }',
    "late": 'toe = { x = "0.09 - 0.5*(lambda - 2)**2 / (1 + lambda)", y = "0.12 + (lambda - 2)/8", start = 2, end = 3 }',
    "polynomial": "toe = { polynomial = [5.0, -12.0], end = 0.095 }",
    "circle": "toe = { ellipse = [0.07, 0.07], end_deg = 80 }",
    "spline": "toe = { points = [[0.085, 0.15], [0.07, 0.18], [0.04, 0.205]] }",
}
"""Toes given in every way."""
EVERY = [pytest.param(name, marks=() if name == "ellipse" else pytest.mark.nightly) for name in CURVES]
"""One by day, all by night."""


def leg_text(curve=CURVES["ellipse"], functions=STANCE + FORCES, name="roller", targets=("c", "numpy", "casadi")):
    """The shipped leg with another toe."""
    text = LEG.replace('name = "anthropomorphic_leg"', f'name = "{name}"').replace(CURVES["ellipse"], curve)
    wanted = ", ".join(f'"{function}"' for function in functions)
    return text + f"\n[generate]\nfunctions = [{wanted}]\ntargets = [{', '.join(map(repr, targets))}]\n".replace("'", '"')


def robot_of(made, backend):
    return made.numpy if backend == "numpy" else made.c


def called(made, backend, name, *inputs, **parameters):
    """All outputs of a function of one leg, for one row; `param` where it has any."""
    robot = robot_of(made, backend)
    leg = next(iter(robot.legs))
    if backend != "casadi":
        return tuple(np.asarray(part) for part in _outputs(getattr(robot.legs[leg], name)(*inputs, **parameters)))
    function = robot.casadi(f"{robot.name}_{leg}_{name}")
    given = [np.reshape(value, function.size_in(index)) for index, value in enumerate((*inputs, *parameters.values()))]
    shapes = [np.shape(part) for part in _outputs(getattr(robot.legs[leg], name)(*inputs, **parameters))]
    return tuple(np.array(part).reshape(shape) for part, shape in zip(function.call(given), shapes, strict=True))


def _outputs(found):
    return found if isinstance(found, tuple) else (found,)


def end_of(curve):
    """The largest parameter, of curves that say one."""
    degrees, plain = re.search(r"end_deg = ([\d.]+)", curve), re.search(r"\bend = ([\d.]+)", curve)
    return np.radians(float(degrees[1])) if degrees else float(plain[1])


def direction(angle):
    return np.stack([np.cos(angle), np.sin(angle)], -1)


def across(angle):
    return np.stack([-np.sin(angle), np.cos(angle)], -1)


def foot_forward(made, contact, edge, which="toe"):
    """Foot angle, arc length, contact point and ankle with derivatives, in rows."""
    leg = next(iter(made.c.legs.values()))
    return getattr(leg, f"{which}_rolling")(contact, edge)


def random_states(made, bounds, rows, seed, which="toe"):
    """Hips, thighs and edges of states that forward kinematics makes, with any rates; the contact parameters and shanks that made them."""
    random = np.random.default_rng(seed)
    contact = bounds[0] + random.uniform(0.02, 0.98, rows) * (bounds[1] - bounds[0])
    edge, thigh, shank = random.uniform(-1, 1, rows), random.uniform(-1.6, -0.9, rows), random.uniform(-2.7, -2.1, rows)
    ankle = foot_forward(made, contact, edge, which)[3][:, 0]
    hip = np.zeros((rows, 3, 2))
    hip[:, 0] = ankle - SHANK * direction(shank) - THIGH * direction(thigh)
    hip[:, 1:] = random.uniform(-2, 2, (rows, 2, 2))
    motion = np.column_stack([thigh, random.uniform(-4, 4, (rows, 2))])
    return hip, motion, edge, contact, shank
