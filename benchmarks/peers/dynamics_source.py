"""What the peers of benchmarks/dynamics.py share: the expressions of every function, and C around them as the harness calls it."""

from collections.abc import Callable, Iterator, Sequence
from itertools import accumulate

from motions import FUNCTIONS, DynamicFunction
from multibody import leg_robot, mero_robot
from peers.dynamics_closed import CLOSED
from peers.dynamics_formulas import FORMS, Recursion, accelerations, solved
from peers.dynamics_vectors import Vector, cross, minus, plus, times, transposed
from peers.formulas import Algebra

LEG = tuple(function for function in FUNCTIONS if function.robot == "leg")
MERO = tuple(function for function in FUNCTIONS if function.robot == "mero")
LEG_FORMS = (*FORMS, "closed")
"""`closed`: Lagrange's equations of this one leg, simplified by hand."""

CLOSED_SUFFIX = ", closed"

Ports = dict[str, Vector]
"""Elements of every input port, by its name."""


def expressions(function: DynamicFunction, algebra: Algebra, ports: Ports, form: str) -> Vector:
    """A function's output, row-major."""
    if form == "closed":
        return CLOSED[function.name](algebra, ports)
    return _BUILDERS[function.name](algebra, ports, form)


def _leg_efforts(algebra: Algebra, ports: Ports, form: str) -> Vector:
    leg = Recursion(algebra, leg_robot(), ports["q"], form)
    return leg.efforts(_held(algebra), ports["qd"], ports["qdd"], [ports["f"]])[2]


def _leg_mass_matrix(algebra: Algebra, ports: Ports, form: str) -> Vector:
    """By composite bodies, or by efforts of unit accelerations where centres of mass are taken."""
    leg = Recursion(algebra, leg_robot(), ports["q"], form)
    if form == "origins":
        return [entry for row in leg.mass_matrix() for entry in row]
    units = [[int(row == column) for row in range(3)] for column in range(3)]
    return [entry for unit in units for entry in leg.efforts(_STILL, [0] * 3, unit)[2]]


def _leg_accelerations(algebra: Algebra, ports: Ports, form: str) -> Vector:
    leg = Recursion(algebra, leg_robot(), ports["q"], form)
    bias = leg.efforts(_held(algebra), ports["qd"], [0] * 3, [ports["f"]])[2]
    return accelerations(leg.mass_matrix(), minus(ports["tau"], bias))


def _leg_bias_acceleration(algebra: Algebra, ports: Ports, form: str) -> Vector:
    return Recursion(algebra, leg_robot(), ports["q"], form).bias_acceleration(ports["qd"])


def _leg_inverse_rates(algebra: Algebra, ports: Ports, form: str) -> Vector:
    leg = Recursion(algebra, leg_robot(), ports["q_bent"], form)
    columns = leg.jacobian_columns()
    qd = solved(columns, ports["v"])
    return [*qd, *solved(columns, minus(ports["a"], leg.bias_acceleration(qd)[:3]))]


_STILL = ([0, 0, 0], [0, 0, 0], [0, 0, 0])


def _held(algebra: Algebra) -> tuple[Vector, Vector, Vector]:
    """A base at rest, less gravity."""
    return [0, 0, 0], [0, 0, 0], [0, 0, algebra.number("9.80665")]


def _mero_efforts(algebra: Algebra, ports: Ports, form: str) -> Vector:
    mero = Recursion(algebra, mero_robot(), ports["q"], form)
    inwards = transposed([ports["base_pose"][4 * row : 4 * row + 3] for row in range(3)])
    velocity, spin, linear, rate = ports["v"][:3], ports["v"][3:6], ports["a"][:3], ports["a"][3:6]
    lift = times(inwards, [0, 0, algebra.number("9.80665")])
    base = (spin, rate, plus(plus(linear, cross(spin, velocity)), lift))
    forces = [times(inwards, ports["foot_forces"][3 * foot : 3 * foot + 3]) for foot in range(6)]
    force, moment, efforts = mero.efforts(base, ports["v"][6:], ports["a"][6:], forces)
    return [*force, *moment, *efforts]


def _mero_mass_matrix(algebra: Algebra, ports: Ports, form: str) -> Vector:
    mero = Recursion(algebra, mero_robot(), ports["q"], form)
    return [entry for row in mero.mass_matrix() for entry in row]


_BUILDERS: dict[str, Callable[[Algebra, Ports, str], Vector]] = {
    "leg_inverse_dynamics": _leg_efforts,
    "leg_mass_matrix": _leg_mass_matrix,
    "leg_forward_dynamics": _leg_accelerations,
    "leg_bias_acceleration": _leg_bias_acceleration,
    "leg_inverse_rates": _leg_inverse_rates,
    "mero_inverse_dynamics": _mero_efforts,
    "mero_mass_matrix": _mero_mass_matrix,
}


def entrant(generator: str, form: str) -> str:
    """A generator given simplified equations competes under a name of its own."""
    return generator + (CLOSED_SUFFIX if form == "closed" else "")


# ---- C


def core(function: DynamicFunction, body: str) -> str:
    """`static inline void core_<name>(ports..., out)` around statements that compute `out`."""
    arguments = ", ".join([*(f"const double *RESTRICT {name}" for name, _ in function.inputs), "double *RESTRICT out"])
    unused = "".join(f"    (void){name};\n" for name, _ in function.inputs)
    return f"static inline void core_{function.name}({arguments}) {{\n{unused}{body}\n}}\n"


def adapter(functions: Sequence[DynamicFunction], batch: Callable[[DynamicFunction], str] | None = None) -> str:
    """The functions that the harness times around `core_*`; `batch` names one of the generator's own, otherwise the batch is a loop."""
    return "\n".join(line for function in functions for line in _adapted(function, batch(function) if batch else ""))


def _adapted(function: DynamicFunction, batch: str) -> Iterator[str]:
    row = ", ".join(f"in + {start}" for start in _starts(function))
    yield f"ENTRY int32_t bench_{function.name}(ROW) {{"
    yield f"    (void)branch;\n    (void)status;\n    core_{function.name}({row}, out);\n    return 0;\n}}"
    yield f"ENTRY size_t bench_{function.name}_batch(ROWS) {{\n    (void)branch;\n    (void)status;"
    blocks = [f"in + {start} * rows" for start in _starts(function)]
    if batch:
        used = [block for block, (name, _) in zip(blocks, function.inputs, strict=True) if name != "configuration"]
        yield f"    {batch}(rows, {', '.join(used)}, out);\n    return 0;\n}}"
        return
    each = [f"{block} + {size} * i" for block, (_, size) in zip(blocks, function.inputs, strict=True)]
    call = f"core_{function.name}({', '.join(each)}, out + {function.size} * i);"
    yield f"    for (size_t i = 0; i < rows; ++i) {{\n        {call}\n    }}\n    return 0;\n}}"


def _starts(function: DynamicFunction) -> list[int]:
    sizes = [size for _, size in function.inputs]
    return [0, *accumulate(sizes[:-1])]


HEAD = """#include <math.h>
#include <stddef.h>
#include <stdint.h>
#ifdef __cplusplus
#define RESTRICT __restrict__
#define ENTRY extern "C" __attribute__((visibility("default")))
#else
#define RESTRICT restrict
#define ENTRY __attribute__((visibility("default")))
#endif
#define ROW const double *RESTRICT in, int32_t branch, double *RESTRICT out, int32_t *RESTRICT status
#define ROWS size_t rows, const double *RESTRICT in, const int32_t *RESTRICT branch, double *RESTRICT out, int32_t *RESTRICT status
"""
