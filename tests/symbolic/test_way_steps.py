"""The steps that close triads where there are no routines never go on from a dead point to another assembly."""

from dataclasses import dataclass

import numpy as np
import sympy

from walkgen.signature import Port
from walkgen.symbolic.way_steps import Way

NAMED = {
    "Select": np.where,
    "Less": np.less,
    "LessEqual": np.less_equal,
    "Same": np.equal,
    "Both": np.logical_and,
    "Either": np.logical_or,
    "Opposite": np.logical_not,
    "Indicator": lambda truth: np.where(truth, 1.0, 0.0),
}


@dataclass
class Wavy:
    """x + size sin(number x) / number = z and y = x / 2, whose first dead point is known; `given` are z, size and number."""

    tape: object
    given: tuple[sympy.Expr, ...]
    unknowns: tuple[sympy.Symbol, ...]

    @property
    def residuals(self):
        (z, size, number), (x, y) = self.given, self.unknowns
        return (x + size / number * sympy.sin(number * x) - z, y - x / 2)

    @property
    def slopes(self):
        (_, size, number), (x, _) = self.given, self.unknowns
        return ((1 + size * sympy.cos(number * x), sympy.S.Zero), (-sympy.S.Half, sympy.S.One))


def by_numpy(function):
    """A function of as many arrays as it has inputs."""
    symbols = (*function.inputs, *(symbol for symbol, _ in function.intermediates))
    plain = {symbol: sympy.Symbol(f"v{number}") for number, symbol in enumerate(symbols)}
    lines = [(plain[symbol], definition.xreplace(plain)) for symbol, definition in function.intermediates]
    outputs = [output.xreplace(plain) for output in function.outputs]
    return sympy.lambdify([plain[symbol] for symbol in function.inputs], outputs, [NAMED, "numpy"], cse=lambda _: (lines, outputs))


def test_no_way_leads_beyond_a_dead_point():
    way = Way("bot", "leg", "wavy", Port("given", (3,)), 2, lambda given, unknowns, tape: Wavy(tape, tuple(given), tuple(unknowns)))
    begin, advance, random = by_numpy(way.begin), by_numpy(way.advance), np.random.default_rng(1)
    size, number = random.uniform(1.05, 6, (400, 1)), 10 ** random.uniform(0, 2, (400, 1))
    turn = np.arccos(-1 / size)
    last = (turn + size * np.sin(turn)) / number
    z = last * random.uniform(0, 20 / size, (400, 30))
    aim, start = (z, size, number), (0 * z, size, number, 0 * z, 0 * z)
    with np.errstate(all="ignore"):
        state = begin(*start)
        for _ in range(way.steps("aim", "start", "state")[1].repeat):
            state = advance(*aim, *start, *state)
    gone, x = state[0], state[3]
    before, beyond = z < last * (1 - 1e-3), z > last * (1 + 1e-3)
    assert before.sum() > 1000
    assert beyond.sum() > 1000
    assert np.abs((x + size / number * np.sin(number * x) - z)[before]).max() < 1e-12
    assert (gone[before] == 1).all()
    assert (gone[beyond] < 1).all()
    assert np.mean(np.abs(gone * z / last - 1)[beyond] < 1e-2) > 0.9  # the others stop further on
