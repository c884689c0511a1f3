"""Newton's method on Pinocchio's C++ kinematics; one unit for all problems, since its headers take a minute to compile."""

from collections.abc import Iterable
from functools import cache

from peers.eigen import HEADERS
from peers.pinocchio_cpp import LINK, PREFIX
from peers.solver import SEEDS, Refuse, Solver
from peers.source import HERE, Source
from problems import Problem, problems

_FLAGS = ("-O3", "-march=native")
_FORMS = {"newton": "Newton, C++", "damped": "damped Newton, C++"}


@cache
def _source() -> Source:
    text = f"#define CHAINS(X) {' '.join(map(_chain, problems(1)))}\n{(HERE / 'newton.cpp').read_text()}"
    return Source("Pinocchio", "C++", text, "c++", (PREFIX / "include", HEADERS), LINK, _FLAGS)


def _chain(problem: Problem) -> str:
    chain = problem.chain
    rows = ", ".join(repr(number) for row in chain.rows for number in row)
    return f'X({problem.name}, {len(chain.kinds)}, {str(problem.posed).lower()}, "{chain.kinds}", {rows})'


def solvers(problem: Problem, _: Refuse) -> Iterable[Solver]:
    """Whole steps, and damped ones."""
    for symbol, form in _FORMS.items():
        yield Solver("Pinocchio", form, SEEDS, 1, source=_source(), symbol=f"{problem.name}_{symbol}")
