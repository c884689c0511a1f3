"""The self-test beside a robot: its reference against plain numbers, that it passes on right code and fails on wrong code."""

import re
from decimal import Decimal

import pytest
from c_bench import STRICT, Builder, code, mechanism, needs_gcc, run, write

from walkgen.emit.artifact import RobotCode
from walkgen.emit.reference import EXPECTED, Sample
from walkgen.emit.selftest import selftest_artifact
from walkgen.graph.program import Code, Program
from walkgen.model.mechanism import Joint, Limb, Mechanism, Motion, Platform
from walkgen.model.walk import CONTEXT
from walkgen.signature import Port
from walkgen.spec.scalar import ZERO, Pi, exact

Q = Port("q", (2,), "rad")
P = Port("p", (3,), "m")
STEP = CONTEXT.mpf(10) ** -15


def planar(length: str = "0.3") -> tuple[Program, Program]:
    """Position and Jacobian of the bench's leg: two links of 0.3 m in the plane z = 0, written by hand."""
    b = Builder(Q)
    a = b.constant(length)
    total = b.add(Code.ADD, 0, 1)
    first = [b.add(Code.MUL, a, b.add(part, 0)) for part in (Code.COS, Code.SIN)]
    second = [b.add(Code.MUL, a, b.add(part, total)) for part in (Code.COS, Code.SIN)]
    x, y = (b.add(Code.ADD, one, two) for one, two in zip(first, second, strict=True))
    zero = b.constant("0")
    jacobian = [b.add(Code.NEG, y), b.add(Code.NEG, second[1]), x, second[0], zero, zero]
    return b.program("foot_position", [P], [x, y, zero]), b.program("foot_jacobian", [Port("J", (3, 2), "m/rad")], jacobian)


def outcome(folder, robot: RobotCode) -> tuple[int, list[str]]:
    """Exit code and lines of the compiled self-test."""
    write(folder, robot)
    name = robot.mechanism.name
    (folder / f"{name}_test.c").write_text(selftest_artifact(robot).text)
    run("gcc", *STRICT, "-I", folder, folder / f"{name}_test.c", folder / f"{name}.c", "-o", folder / "test", "-lm")
    lines = run("sh", "-c", f"{folder}/test; echo $?").splitlines()
    return int(lines[-1]), lines[:-1]


@needs_gcc
def test_right_code_passes(tmp_path):
    status, lines = outcome(tmp_path, code(*planar()))
    assert status == 0
    assert lines[-1] == "2 passed, 0 failed"
    assert [line.split()[:2] for line in lines[:-1]] == [["ok", "bot_leg_foot_position,"], ["ok", "bot_leg_foot_jacobian,"]]


@needs_gcc
@pytest.mark.parametrize("length", ["0.3000000001", "NaN"])
def test_wrong_code_fails(tmp_path, length):
    right, _ = planar()
    _, wrong = planar(length)
    status, lines = outcome(tmp_path, code(right, wrong, float32=False))
    assert status == 1
    assert lines[-1] == "1 passed, 1 failed"
    assert lines[1].startswith("FAILED bot_leg_foot_jacobian, worst error ")


def crooked() -> Mechanism:
    """A chain with a slider, then a leg with a slider, a backward joint and skew axes."""
    tilt, turn = (Motion("rotate", 0, exact(1)),), (Motion("rotate", 1, Pi()),)
    nothing = (None, None, None, None, "", "")
    yaw = Joint("yaw", "revolute", tilt, -1, exact(Decimal("0.2")), (), *nothing)
    slide = Joint("slide", "prismatic", turn, 1, ZERO, tilt, *nothing)
    lift = Joint("lift", "prismatic", tilt, -1, ZERO, (), *nothing)
    reach = (Motion("translate", 0, exact(Decimal("0.4"))), Motion("rotate", 2, exact(1)))
    chain = Limb("waist", 0, (Motion("translate", 1, exact(1)),), (yaw, slide), reach, child=1)
    leg = Limb("leg", 1, reach, (yaw, lift, yaw), reach)
    platforms = (Platform("base", None, None), Platform("waist", 0, None))
    return Mechanism("bot", "", (ZERO, ZERO, exact(-10)), platforms, (chain,), (leg,), (), ())


def sample(time=0) -> Sample:
    """The crooked robot's whole route, moved along qd by `time`."""
    robot = crooked()
    q, qd = [CONTEXT.mpf(value) / 8 for value in (3, -2, 5, 1, -7)], [CONTEXT.mpf(value) / 4 for value in (2, 3, -1, 5, -3)]
    moved = tuple(value + time * rate for value, rate in zip(q, qd, strict=True))
    limbs = (robot.chains[0], robot.legs[0])
    return Sample(robot, limbs, moved, tuple(qd), tuple(reversed(qd)), tuple(qd[:3]))


def slope(name: str, of=lambda found: found[0]) -> list:
    """Central difference in time of a function along the motion."""
    ahead, behind = (of(EXPECTED[name](sample(side * STEP))) for side in (1, -1))
    return [(a - b) / (2 * STEP) for a, b in zip(ahead, behind, strict=True)]


def close(got, wanted) -> bool:
    return len(got) == len(wanted) and all(abs(a - b) < CONTEXT.mpf(10) ** -18 for a, b in zip(got, wanted, strict=True))


def test_reference_velocity_is_the_slope_of_position():
    assert close(EXPECTED["foot_velocity"](sample())[0], slope("foot_position"))


def test_reference_bias_is_the_slope_of_the_spatial_jacobian():
    change = slope("foot_spatial_jacobian")
    qd = sample().qd
    rows = [sum(change[5 * row + place] * qd[place] for place in range(5)) for row in range(6)]
    assert close(EXPECTED["foot_bias_acceleration"](sample())[0], rows)


def test_reference_hessian_is_the_slope_of_the_jacobian():
    hessian, qd = EXPECTED["foot_hessian"](sample())[0], sample().qd
    along = [sum(hessian[25 * row + 5 * i + j] * qd[j] for j in range(5)) for row in range(3) for i in range(5)]
    assert close(along, slope("foot_jacobian"))


def test_reference_angular_columns_turn_the_rotation():
    spatial, qd = EXPECTED["foot_spatial_jacobian"](sample())[0], sample().qd
    rate = [sum(spatial[5 * row + place] * qd[place] for place in range(5)) for row in (3, 4, 5)]
    rotation, turning = EXPECTED["foot_rotation"](sample())[0], slope("foot_rotation")
    for column in range(3):
        axis = [rotation[3 * row + column] for row in range(3)]
        x, y, z = rate
        crossed = [y * axis[2] - z * axis[1], z * axis[0] - x * axis[2], x * axis[1] - y * axis[0]]
        assert close(crossed, [turning[3 * row + column] for row in range(3)])


def test_reference_torque_does_the_work_of_the_force():
    torque = EXPECTED["foot_torque"](sample())[0]
    velocity = EXPECTED["foot_velocity"](sample())[0]
    work = sum(a * b for a, b in zip(torque, sample().qd, strict=True))
    assert close([work], [sum(a * b for a, b in zip(velocity, sample().f, strict=True))])


def test_samples_are_exact_doubles():
    text = selftest_artifact(RobotCode(mechanism(), planar(), "0" * 64)).text
    table = re.search(r"static const double q_\d\[3\]\[2\] = {(.*?)};", text, re.DOTALL)
    assert table
    assert "e-" not in table[1]
