"""Legs of Denavit-Hartenberg rows with exact numbers: as the closed-form inverse takes them, as the oracle does, and as functions."""

from itertools import product

import numpy as np
import sympy
from numpy.random import Generator

from mechanisms.hand_programs import run, toy
from oracles.screws import Screws
from walkgen.emit.casadi_printer import casadi_artifact
from walkgen.emit.numpy_printer import numpy_artifact
from walkgen.graph.lower import lower
from walkgen.signature import Port, Signature
from walkgen.symbolic.general import general_rows
from walkgen.symbolic.tape import Tape, constant, symbols_of

SEQUENCES = tuple("".join(kinds) for count in (1, 2, 3) for kinds in product("RP", repeat=count))
TARGET = Port("p", (3,), "m")
TWISTS = {"z": sympy.S.Zero, "p": sympy.pi / 2, "x": None}
"""Between two axes: parallel, at a right angle, askew."""


def number(kinds: str) -> int:
    """The sequence as the routines write it."""
    return int("1" + kinds.replace("R", "0").replace("P", "1"), 2)


def exact(kinds, rows, foot):
    """Numbers of a leg of rows (theta, d, a, alpha), [6 n + 3]: theta and d at q = 0."""
    pose, numbers = sympy.eye(4), []
    for _, (theta, d, a, alpha) in zip(kinds, rows, strict=True):
        numbers += [*pose[:3, 2], *pose[:3, 3]]
        c, s, ca, sa = sympy.cos(theta), sympy.sin(theta), sympy.cos(alpha), sympy.sin(alpha)
        step = sympy.Matrix([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
        pose = (pose * step).applyfunc(lambda item: constant(item) if item.is_number else item)
    return [*numbers, *(pose * sympy.Matrix([*foot, 1]))[:3]]


def random_numbers(kinds: str, twists: str, generator: Generator):
    """A leg with these twists after every joint but the last, everything else random thousandths."""

    def some(most):
        return sympy.Rational(int(generator.integers(50, 1000 * most)), 1000) * int(generator.choice([-1, 1]))

    alphas = [TWISTS[twist] if TWISTS[twist] is not None else some(3) for twist in (*twists, "x")]
    return exact(kinds, [(some(3), some(0.3), some(0.5), alpha) for alpha in alphas], [some(0.3) for _ in range(3)])


def oracle(kinds: str, numbers) -> Screws:
    """The same leg for the oracle."""
    values = np.array([float(item) for item in numbers])
    joints = values[:-3].reshape(-1, 2, 3)
    tip = np.eye(4)
    tip[:3, 3] = values[-3:]
    return Screws(joints[:, 0], joints[:, 1], np.array([kind == "R" for kind in kinds]), tip)


def function(kinds: str, numbers, parameters: int = 0):
    """The inverse as a Function: p (and param) to q [b,n] and status [b]."""
    tape = Tape()
    rows = general_rows(numbers, symbols_of(TARGET), number(kinds), tape)
    inputs = (TARGET, Port("param", (parameters,), "m")) if parameters else (TARGET,)
    outputs = (Port("q", (len(rows), len(kinds)), "rad"), Port("status", (len(rows),), kind="integer"))
    return tape.function(
        Signature("toy", "leg", "inverse", inputs, outputs, "", ""), [*(x for q, _ in rows for x in q), *(s for _, s in rows)]
    )


def numpy_inverse(folder, kinds: str, numbers, parameters: int = 0):
    """The printed NumPy function."""
    return run(numpy_artifact(toy(lower(function(kinds, numbers, parameters)))), folder)["leg_inverse"]


def casadi_inverse(folder, kinds: str, numbers):
    """The printed CasADi function."""
    return run(casadi_artifact(toy(lower(function(kinds, numbers)))), folder)["function"]("toy_leg_inverse")
