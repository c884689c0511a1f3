"""Legs for tests of dynamics: their Programs by name, and values from the interpreter in doubles or many digits."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpmath.ctx_mp import MPContext

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Program
from walkgen.pipeline import mechanism_of
from walkgen.symbolic.leg_functions import DYNAMICS, LegFunctions
from walkgen.symbolic.robot_dynamics import ROBOT_DYNAMICS, FloatingFunctions

Array = np.ndarray
SPECS = Path(__file__).parents[2] / "specs"
EXACT = MPContext()
EXACT.dps = 50
STEP = EXACT.mpf(10) ** -20

PLANE = """walkgen = 1
[robot]
name = "bench"
gravity = [0.0, 0.0, -9.80665]
{parameters}
[leg_designs.arm]
dh = "classic"
foot = {{ xyz = [0.02, 0.0, -0.01] }}
joints = [
{joints}
]
[[platforms]]
name = "base"
mass = 3.0
com = [0.1, -0.05, 0.02]
inertia = [0.05, 0.06, 0.07, 0.001, 0.002, -0.003]
[[legs]]
name = "leg"
design = "arm"
platform = "base"
mount = {{ xyz = [0.1, 0.2, -0.1], rpy_deg = [20, -35, 60] }}
"""
BODY = "link = { mass = 1.1, com = [-0.1, 0.02, 0.03], inertia = [0.01, 0.02, 0.025, 0.001, -0.002, 0.003] }"
YAW = 'name = "yaw", type = "revolute", a = 0.05, alpha_deg = 90, d = 0.1'
THIGH = 'name = "thigh", type = "revolute", a = 0.3, alpha_deg = 0, d = 0.04'
SLIDE = 'name = "slide", type = "prismatic", a = 0.1, alpha_deg = 70, d = 0.2, theta_deg = 25'


def spec_of(*joints: str, parameters: str = "") -> str:
    """A robot with one leg of these rows."""
    return PLANE.format(joints=",\n".join(f"{{ {joint} }}" for joint in joints), parameters=parameters)


def written(folder: Path, text: str) -> Path:
    path = folder / "spec.toml"
    path.write_text(text, encoding="utf-8")
    return path


def leg_programs(spec: Path, index: int = 0, names: Sequence[str] = tuple(DYNAMICS)) -> dict[str, Program]:
    """Of one leg, unfused."""
    mechanism = mechanism_of(spec)
    functions = LegFunctions(mechanism, mechanism.legs[index])
    derived = {name: functions.function(name) for name in names}
    return {name: lower(function, fma=False) for name, function in derived.items() if function}


def robot_programs(spec: Path) -> dict[str, Program]:
    """Of the robot, unfused."""
    functions = FloatingFunctions(mechanism_of(spec))
    derived = {name: functions.function(name) for name in ROBOT_DYNAMICS}
    return {name: lower(function, fma=False) for name, function in derived.items() if function}


def value(program: Program, *inputs: Any, context: Any = None) -> Any:
    """The only output; as `values`."""
    (found,) = values(program, *inputs, context=context)
    return found


def values(program: Program, *inputs: Any, context: Any = None) -> list[Any]:
    """Every output, shaped; inputs left out at the end are zeros; with a context, exact numbers in an object array."""
    ports = program.signature.inputs
    given = [np.ravel(np.asarray(entry)) for entry in inputs]
    given += [np.zeros(port.size) for port in ports[len(given) :]]
    table = {port.name: list(entry) for port, entry in zip(ports, given, strict=True)}
    found = interpret(program, table, context) if context else interpret(program, table)
    kind = object if context else float
    return [np.array(found[port.name], dtype=kind).reshape(port.shape)[()] for port in program.signature.outputs]


def exact(values: Any) -> Array:
    """Numbers of many digits."""
    return np.array([EXACT.mpf(float(entry)) for entry in np.ravel(values)], dtype=object).reshape(np.shape(values))


def rate_along(function: Callable[[Array], Array], q: Array, qd: Array) -> Array:
    """Derivative in the direction qd, by differences of 50-digit numbers: right to 1e-20."""
    return (function(q + STEP * qd) - function(q - STEP * qd)) / (2 * STEP)
