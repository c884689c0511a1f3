"""Every forward function of random legs, in both conventions, against textbook matrices and sympy's own derivatives to 30 digits."""

import random
from functools import cache

import pytest
import sympy
from textbook import CONTEXT, Leg, Row

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.model.assemble import assemble
from walkgen.spec.functions import FORWARD_FUNCTIONS
from walkgen.spec.read import read
from walkgen.symbolic.derive import derive
from walkgen.symbolic.function import Solve

TOLERANCE = CONTEXT.mpf(10) ** -30
ANGLES = (0, 90, -90, 180, 30, -60, 45)
DESIGNS = [(convention, seed) for convention in ("classic", "craig") for seed in range(5)]


def number(generator, choices, span):
    """Zero, a special value, or anything with three digits."""
    if generator.random() < 0.5:
        return sympy.Rational(generator.choice(choices))
    return sympy.Rational(generator.randint(-1000 * span, 1000 * span), 1000)


def random_leg(convention, seed):
    generator = random.Random(f"{convention} {seed}")
    rows = []
    for _ in range(2 + seed % 3):
        kind = generator.choice(("revolute", "revolute", "prismatic"))
        a, d = number(generator, (0, 0, "1/4"), 1), number(generator, (0,), 1)
        rows.append(Row(kind, a, number(generator, ANGLES, 180), d, number(generator, ANGLES, 180)))
    return Leg(convention, tuple(rows))


def spec_text(leg):
    joints = ",\n".join(f'  {{ name = "joint{index}", {row.text} }}' for index, row in enumerate(leg.rows))
    return f"""walkgen = 1
[robot]
name = "textbook"
gravity = [0, 0, -9.81]
[leg_designs.leg]
dh = "{leg.convention}"
joints = [
{joints},
]
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "leg"
platform = "body"
"""


@cache
def leg_of(design):
    return random_leg(*design)


@pytest.fixture(scope="module")
def functions(tmp_path_factory):
    """Programs of a design's leg by the functions' names."""

    @cache
    def derived(design):
        path = tmp_path_factory.mktemp("textbook") / "spec.toml"
        path.write_text(spec_text(leg_of(design)), encoding="utf-8")
        found = [function for function in derive(assemble(read(path)), FORWARD_FUNCTIONS) if not isinstance(function, Solve)]
        return {function.signature.name: lower(function, fma=bool(design[1] % 2)) for function in found if function.signature.owner}

    return derived


def point(design, name):
    generator = random.Random(f"{design} {name}")
    return [CONTEXT.mpf(generator.randint(-3000, 3000)) / 1009 for _ in leg_of(design).rows]


def expectations(design):
    """Inputs and the value of every function at one random point."""
    q, qd, qdd = (point(design, name) for name in ("q", "qd", "qdd"))
    pose = leg_of(design).at(q)
    count, force = len(q), [CONTEXT.mpf(value) for value in (3, -5, 7)]
    J, bias = pose.jacobian, pose.bias(qd)
    velocity = [sum(J[row * count + i] * qd[i] for i in range(count)) for row in range(3)]
    rates = [sum(J[row * count + i] * qdd[i] for i in range(count)) for row in range(3)]
    return {
        "foot_position": ({"q": q}, pose.position),
        "foot_rotation": ({"q": q}, pose.rotation),
        "foot_pose": ({"q": q}, pose.frames[-16:]),
        "foot_jacobian": ({"q": q}, J),
        "foot_position_jacobian": ({"q": q}, [*pose.position, *J]),
        "foot_spatial_jacobian": ({"q": q}, [*J, *pose.angular]),
        "foot_hessian": ({"q": q}, pose.hessian),
        "foot_velocity": ({"q": q, "qd": qd}, velocity),
        "foot_acceleration": ({"q": q, "qd": qd, "qdd": qdd}, [a + b for a, b in zip(rates, bias[:3], strict=True)]),
        "foot_bias_acceleration": ({"q": q, "qd": qd}, bias),
        "foot_torque": ({"q": q, "f": force}, [sum(J[row * count + i] * force[row] for row in range(3)) for i in range(count)]),
        "joint_frames": ({"q": q}, pose.frames),
    }


@pytest.mark.sampled(4)
@pytest.mark.parametrize("design", DESIGNS, ids=str)
def test_every_function(functions, design):
    expected = expectations(design)
    assert set(functions(design)) == set(expected)
    for name, (inputs, values) in expected.items():
        found = [element for port in interpret(functions(design)[name], inputs, CONTEXT).values() for element in port]
        assert len(found) == len(values), name
        assert max(abs(a - b) for a, b in zip(found, values, strict=True)) <= TOLERANCE, name


@pytest.mark.sampled(4)
@pytest.mark.parametrize("design", DESIGNS, ids=str)
def test_operations_stay_few(functions, design):
    """No function of a serial leg grows faster than its outputs and joints ask for."""
    joints = len(leg_of(design).rows)
    for name, program in functions(design).items():
        assert program.operation_count <= 20 * joints + 12 * joints**2 + 2 * len(program.outputs), name
