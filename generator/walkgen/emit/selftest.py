"""The self-test generated beside a robot: C with expected values from a 50-digit walk over the Mechanism, never from a Program.

Linkages are closed by Newton's method on all their loops at once, where the Program places dyad after dyad.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from walkgen.emit.artifact import Artifact, RobotCode
from walkgen.emit.c_constants import limb_owner
from walkgen.emit.c_declaration import function_name
from walkgen.emit.c_printer import DOUBLE
from walkgen.emit.c_text import banner
from walkgen.emit.layout import lay_out
from walkgen.emit.reference import EXPECTED, Numbers, Sample, elements, sole_corners, sole_normal
from walkgen.emit.samples import apart, is_regular, robot_rows, samples_of
from walkgen.emit.selftest_tables import Check, Row, Table, literal, sharing, table
from walkgen.model.classify import inverse_class
from walkgen.model.closing import KnownStart
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import CONTEXT, defaults, platform_poses
from walkgen.signature import Port, Signature

_TIGHT, _LOOSE = "1e-12", "1e-9"


def selftest_artifact(code: RobotCode) -> Artifact:
    """`<robot>_test.c`: needs only libm and the library."""
    robot = code.mechanism
    checks, tables = sharing(tuple(_checks(robot, [body.signature for body in code.functions], dict(_starts(code)))))
    return lay_out(
        "robot_test.c.jinja",
        f"{robot.name}_test.c",
        banner=banner(code, "Self-test; expected values come from a 50-digit matrix walk over the mechanism, not from the generated code."),
        header=f"{robot.name}.h",
        parameters=[literal(value) for value in defaults(robot).values()] or ["0.0"],
        tables=tables,
        checks=checks,
    )


def _starts(code: RobotCode) -> Iterator[tuple[str, KnownStart]]:
    """Of legs with triads: where the code starts from."""
    tables = {table.name: tuple(map(float, table.values)) for table in code.tables}
    for leg in code.mechanism.legs:
        values = tables.get(f"{code.mechanism.name}_{leg.name}_start")
        if leg.linkage is not None and values is not None:
            yield leg.name, KnownStart(values[: leg.linkage.drive_count], values[-2 * len(leg.linkage.forward.triads) :])


def _checks(robot: Mechanism, signatures: Sequence[Signature], starts: Mapping[str, KnownStart]) -> Iterator[Check]:
    """A check for every function whose values the walk gives; samples are walked once for all functions of a path."""
    samples = {owner: samples_of(robot, path, starts.get(path[-1].name)) for owner, path in _paths(robot).items()}
    inverted = {signature.owner for signature in signatures if signature.name in _INVERSES}
    regular = {owner: [sample for sample in samples[owner] if is_regular(sample)] for owner in sorted(inverted & set(samples))}
    rows = robot_rows(robot, starts)
    for signature in signatures:
        if not signature.owner and signature.name in _ROBOT and rows:
            yield _robot_check(robot, signature, rows, starts)
        elif samples.get(signature.owner) and signature.name in _untold(samples[signature.owner][0].limbs[-1]):
            continue
        elif samples.get(signature.owner) and signature.name in EXPECTED:
            yield _forward(signature, samples[signature.owner])
        elif samples.get(signature.owner) and signature.name == "assembly_status":
            yield _assembly(signature, samples[signature.owner])
        elif regular.get(signature.owner) and signature.name in _INVERSES:
            yield _INVERSES[signature.name](signature, regular[signature.owner])


def _untold(leg: Limb) -> tuple[str, ...]:
    """Functions whose values nothing else gives: of a leg with triads their angles, and which rows straight ways lead to; of one with a
    curved sole the inverse, which puts it flat.
    """
    if leg.curved_sole is not None:
        return ("inverse", "inverse_branch")
    if leg.linkage is None:
        return ()
    angles = ("transmission_angles",) if leg.linkage.forward.triads else ()
    follows = leg.linkage.drive_count > 1 and leg.linkage.inverse.triads
    return (*angles, *(("inverse", "inverse_branch") if follows else ()))


def _paths(robot: Mechanism) -> dict[str, tuple[Limb, ...]]:
    """The limbs between a function owner's base and tip."""
    routes = {f"root_to_{leg.name}": (*robot.ancestors(leg.platform), leg) for leg in robot.legs}
    return routes | {limb_owner(robot, limb): (limb,) for limb in robot.limbs}


def _forward(signature: Signature, samples: Sequence[Sample]) -> Check:
    expected = [EXPECTED[signature.name](sample) for sample in samples]
    tables = _given(signature, [{"q": s.q, "qd": s.qd, "qdd": s.qdd, "f": s.f} for s in samples])
    return _compared(signature, tables, expected)


def _compared(signature: Signature, tables: tuple[Table, ...], expected: Sequence[tuple[Numbers, ...]]) -> Check:
    """A check that outputs equal tables."""
    outputs = signature.outputs
    wanted = [table(f"{port.name}_expected", [row[place] for row in expected]) for place, port in enumerate(outputs)]
    lines = [f"double {port.name}[{port.size}];" for port in outputs]
    lines.append(f"{_call(signature, [port.name for port in outputs])};")
    lines += [f"worst = worse(worst, {port.name}, {port.name}_expected[sample], {port.size});" for port in outputs]
    return Check(signature.full_name, (*tables, *wanted), len(expected), tuple(lines), _TIGHT)


def _assembly(signature: Signature, samples: Sequence[Sample]) -> Check:
    """The linkage assembles where Newton's method closes it, and not where no start does."""
    out = [q for q in map(apart, samples) if q]
    rows = [*(sample.q for sample in samples), *out]
    expected = [[CONTEXT.zero]] * len(samples) + [[CONTEXT.one]] * len(out)
    tables = (table("q", rows), table("status_expected", expected))
    lines = (f"worst = larger(worst, fabs({_call(signature, [])} - status_expected[sample][0]));",)
    return Check(signature.full_name, tables, len(rows), lines, _TIGHT)


def _call(signature: Signature, outputs: Sequence[str], **replaced: str) -> str:
    inputs = [replaced.get(port.name, "PARAM" if port.name == "param" else f"{port.name}[sample]") for port in signature.inputs]
    return f"{function_name(signature, DOUBLE)}({', '.join([*inputs, *outputs])})"


def _inverse(signature: Signature, samples: Sequence[Sample]) -> Check:
    """The foot's joint values are among the branches."""
    tables = (table("p", [s.position for s in samples]), table("q_expected", [s.q for s in samples]))
    branches, joints = signature.outputs[0].sizes
    lines = (
        f"double q[{branches * joints}];",
        f"int32_t status[{branches}];",
        f"const int32_t ok = {_call(signature, ['q', 'status'])};",
        "double error = HUGE_VAL;",
        f"for (int branch = 0; branch < {branches}; ++branch) {{",
        f"    error = nearer(error, q + branch * {joints}, q_expected[sample], {joints});",
        "}",
        "worst = larger(worst, ok > 0 ? error : HUGE_VAL);",
    )
    return Check(signature.full_name, tables, len(samples), lines, _LOOSE)


def _inverse_branch(signature: Signature, samples: Sequence[Sample]) -> Check:
    """The foot's joint values are on one of the branches."""
    tables = (table("p", [s.position for s in samples]), table("q_expected", [s.q for s in samples]))
    joints, branches = signature.outputs[0].size, len(inverse_class(samples[0].mechanism, samples[0].limbs[-1]).branch_names)
    lines = (
        "double error = HUGE_VAL;",
        f"for (int32_t branch = 0; branch < {branches}; ++branch) {{",
        f"    double q[{joints}];",
        f"    if ({_call(signature, ['q'], branch='branch')} != WALKGEN_BAD_INPUT) {{",
        f"        error = nearer(error, q, q_expected[sample], {joints});",
        "    }",
        "}",
        "worst = larger(worst, error);",
    )
    return Check(signature.full_name, tables, len(samples), lines, _LOOSE)


def _inverse_rate(signature: Signature, samples: Sequence[Sample]) -> Check:
    """The foot's velocity or acceleration gives the joints' back, of redundant joints the least."""
    samples = [replace(sample, qd=tuple(_least(sample, sample.qd))) for sample in samples]
    rows = [{"q": s.q, "qd": s.qd, "v": EXPECTED["foot_velocity"](s)[0], "a": EXPECTED["foot_acceleration"](s)[0]} for s in samples]
    wanted: Mapping[str, Sequence[Row]] = {"qd": [s.qd for s in samples], "qdd": [_least(s, s.qdd) for s in samples]}
    ports = [port for port in signature.outputs if port is not signature.returned]
    lines = (
        *(f"double {port.name}[{port.size}];" for port in ports),
        f"worst = larger(worst, {_call(signature, [port.name for port in ports])} == WALKGEN_OK ? 0.0 : HUGE_VAL);",
        *(f"worst = worse(worst, {port.name}, {port.name}_expected[sample], {port.size});" for port in ports),
    )
    tables = (*_given(signature, rows), *(table(f"{port.name}_expected", wanted[port.name]) for port in ports))
    return Check(signature.full_name, tables, len(samples), lines, _LOOSE)


def _least(sample: Sample, rates: Row) -> Row:
    """The least rates with the same foot velocity, J' (J J')^-1 J rates; of up to three joints the rates themselves."""
    if len(rates) <= 3:
        return rates
    transposed = CONTEXT.matrix(sample.jacobian)
    return list(transposed * CONTEXT.lu_solve(transposed.T * transposed, transposed.T * CONTEXT.matrix(rates)))


_INVERSES = {
    "inverse": _inverse,
    "inverse_branch": _inverse_branch,
    "inverse_velocity": _inverse_rate,
    "inverse_acceleration": _inverse_rate,
    "inverse_velocity_acceleration": _inverse_rate,
}


def _robot_check(robot: Mechanism, signature: Signature, rows: Sequence[Row], starts: Mapping[str, KnownStart]) -> Check:
    expected = [_ROBOT[signature.name](robot, q, starts) for q in rows]
    return _compared(signature, _given(signature, [{"q": q, "ground": _GROUND} for q in rows]), expected)


def _platform_poses(robot: Mechanism, q: Row, starts: Mapping[str, KnownStart]) -> tuple[Numbers, ...]:
    del starts
    return ([element for pose in platform_poses(robot, q) for element in elements(pose)],)


def _foot_samples(robot: Mechanism, q: Row, starts: Mapping[str, KnownStart]) -> Iterator[tuple[Sample, list[int]]]:
    """Every foot's route from the root platform, and which of the robot's joints it runs over."""
    for leg in robot.legs:
        limbs = (*robot.ancestors(leg.platform), leg)
        indices = [robot.offset(limb) + place for limb in limbs for place in range(len(limb.joints))]
        values = tuple(q[index] for index in indices)
        yield Sample(robot, limbs, values, values, values, (), starts.get(leg.name)), indices


def _foot_positions(robot: Mechanism, q: Row, starts: Mapping[str, KnownStart]) -> tuple[Numbers, ...]:
    return ([element for sample, _ in _foot_samples(robot, q, starts) for element in sample.position],)


def _contact_points(robot: Mechanism, q: Row, starts: Mapping[str, KnownStart]) -> tuple[Numbers, ...]:
    return ([element for sample, _ in _foot_samples(robot, q, starts) for corner in sole_corners(sample) for element in corner],)


def _contact_normals(robot: Mechanism, q: Row, starts: Mapping[str, KnownStart]) -> tuple[Numbers, ...]:
    samples = [sample for sample, _ in _foot_samples(robot, q, starts)]
    counts = [sample.limbs[-1].contacts for sample in samples]
    normals = [sole_normal(sample) if count > 1 else _GROUND for sample, count in zip(samples, counts, strict=True)]
    return ([element for normal, count in zip(normals, counts, strict=True) for _ in range(count) for element in normal],)


def _foot_jacobians(robot: Mechanism, q: Row, starts: Mapping[str, KnownStart]) -> tuple[Numbers, ...]:
    rows: Numbers = []
    for sample, indices in _foot_samples(robot, q, starts):
        columns = dict(zip(indices, sample.jacobian, strict=True))
        rows += [columns[joint][row] if joint in columns else CONTEXT.zero for row in range(3) for joint in range(len(q))]
    return (rows,)


_GROUND = (CONTEXT.zero, CONTEXT.mpf(3) / 5, CONTEXT.mpf(4) / 5)
"""A normal that the caller gives."""
_ROBOT = {
    "platform_poses": _platform_poses,
    "foot_positions": _foot_positions,
    "foot_jacobians": _foot_jacobians,
    "contact_points": _contact_points,
    "contact_normals": _contact_normals,
}


def _given(signature: Signature, rows: Sequence[Mapping[str, Row]]) -> tuple[Table, ...]:
    ports: list[Port] = [port for port in signature.inputs if port.name != "param"]
    return tuple(table(port.name, [row[port.name] for row in rows]) for port in ports)
