"""Rules of numbers: they can be computed, lie in their range, do not cross, and inertias belong to real bodies."""

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations

from walkgen.spec.balance import BalanceSpec, CamMasses, CamSpec, CamWeights, RangeWeights
from walkgen.spec.checks_terrain import VARIABLES
from walkgen.spec.curved_sole import CurvedSoleSpec, DirectrixSpec
from walkgen.spec.evaluate import Numbers, Uncomputable
from walkgen.spec.gait import GaitSpec
from walkgen.spec.joint_tables import Friction, JointRow, Link, Rotor
from walkgen.spec.linkage import CylinderSpec, EndMasses, PinFriction, PinSpec, SliderFriction, SliderSpec
from walkgen.spec.linkage_forms import DriveSpec, FiveBar, FourBar, Parallelogram, Stephenson, Watt
from walkgen.spec.problems import Finding, did_you_mean, shown
from walkgen.spec.scalar import CURVE_PARAMETER, Scalar, names
from walkgen.spec.schema import AdaptSpec, Damping, ParameterSpec, PlatformSpec, RobotSpec, SectionSpec, SoleSpec
from walkgen.spec.sole_design import SoleDesignSpec, SoleWeights
from walkgen.spec.springs import SpringSpec
from walkgen.spec.table import Path, Table, entries, is_scalar
from walkgen.spec.terrain import Domain, TerrainPatch

_TOLERANCE = 1e-9
_FOUR_BARS = ("ground", "crank", "coupler", "rocker")
_POSITIVE: Mapping[type[Table], tuple[str, ...]] = {
    JointRow: ("max_speed", "max_speed_deg", "max_speed_mm", "max_effort"),
    SectionSpec: ("E", "G", "A", "Iy", "Iz", "J"),
    Damping: ("epsilon", "lambda_max"),
    SoleSpec: ("length", "length_mm", "width", "width_mm", "kn", "kt"),
    CurvedSoleSpec: ("depth", "depth_mm", "width", "width_mm"),
    DirectrixSpec: ("ellipse",),
    SoleDesignSpec: ("duration", "reach"),
    TerrainPatch: ("spacing", "kn", "kt"),
    GaitSpec: ("period", "pitch", "pitch_mm"),
    FourBar: _FOUR_BARS,
    **dict.fromkeys((Watt, Stephenson), (*_FOUR_BARS, "second_coupler", "second_rocker")),
    Parallelogram: ("ground", "crank"),
    FiveBar: ("cranks", "couplers"),
    **dict.fromkeys((DriveSpec, PinSpec, SliderSpec, CylinderSpec), ("max_speed", "max_effort")),
    PinFriction: ("radius",),
    SpringSpec: ("stiffness",),
    BalanceSpec: ("energy_per_mass",),
    CamSpec: ("start", "roller", "stiffness", "arm", "anchor", "most_pressure_deg"),
}
_NOT_NEGATIVE: Mapping[type[Table], tuple[str, ...]] = {
    Link: ("mass",),
    PlatformSpec: ("mass",),
    Friction: ("viscous", "coulomb"),
    **dict.fromkeys((PinFriction, SliderFriction), ("viscous", "coulomb", "mu")),
    Rotor: ("inertia",),
    TerrainPatch: ("mu",),
    FiveBar: ("ground",),
    GaitSpec: ("lift", "lift_mm"),
    BalanceSpec: ("load",),
    SoleWeights: ("acceleration", "moment"),
    RangeWeights: ("support", "transfer"),
    CamWeights: ("pressure", "force"),
    CamSpec: ("free_length", "initial_tension"),
    CamMasses: ("spring_at_link", "spring_at_follower", "follower", "roller"),
    SpringSpec: ("free_length", "free_length_mm", "initial_tension"),
    EndMasses: ("at_first", "at_second"),
    AdaptSpec: ("limit_weight", "normal_weight", "clearance_weight"),
}
_PAIRS = ("limits", "limits_deg", "limits_mm", "bounds", "stretch")
_DIRECTIONS: Mapping[type[Table], str] = {JointRow: "axis", TerrainPatch: "normal"}
Value = Fraction | float


def check_expressions(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Every number names known parameters and has a value."""
    for path, scalar in entries(spec):
        if is_scalar(scalar):
            yield from _expression(path, scalar, spec, numbers)


def _expression(path: Path, scalar: Scalar, spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    free = _free(path, spec)
    unknown = sorted(names(scalar) - spec.parameters.keys() - set(free))
    place = path[:-1] if path[0] == "parameters" and path[-1] == "value" else path
    for name in unknown:
        cure = did_you_mean(name, [*spec.parameters, *free], "known parameters")
        yield Finding("WG141", place, f'there is no parameter "{shown(name)}"', cure)
    try:
        numbers.value(scalar)
    except Uncomputable as error:
        yield Finding("WG164", place, f"no value: {error}", "mend the expression, or the parameters that it uses")


def _free(path: Path, spec: RobotSpec) -> tuple[str, ...]:
    """Coordinates that the expression may use besides parameters."""
    if path[0] == "leg_designs" and path[2:3] == ("curved_sole",) and path[-1] in ("x", "y"):
        return (CURVE_PARAMETER,)
    if path[0] != "terrain" or not isinstance(path[1], int):
        return ()
    return VARIABLES[spec.terrain[path[1]].surface].get(str(path[2]), ())


def check_ranges(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Signs, directions and pairs of [least, largest]."""
    for path, table in entries(spec):
        if isinstance(table, Table):
            yield from _signs(path, table, numbers)
            yield from _directions(path, table, numbers)
            yield from _pairs(path, table, numbers)
    for name, entry in spec.parameters.items():
        yield from _bounds(name, entry, numbers)


def _signs(path: Path, table: Table, numbers: Numbers) -> Iterator[Finding]:
    for key in _POSITIVE.get(type(table), ()):
        value = getattr(table, key)
        sizes = [numbers.number(entry) for entry in (value if isinstance(value, tuple) else (value,))]
        if any(size is not None and size <= 0 for size in sizes):
            yield Finding(
                "WG161", (*path, key), f"{key} must be more than 0", "give a positive number, or leave the key out where it is optional"
            )
    for key in _NOT_NEGATIVE.get(type(table), ()):
        number = numbers.number(getattr(table, key))
        if number is not None and number < 0:
            yield Finding("WG161", (*path, key), f"{key} must not be negative", "give 0 or a positive number")


def _directions(path: Path, table: Table, numbers: Numbers) -> Iterator[Finding]:
    key = _DIRECTIONS.get(type(table), "")
    sizes = [numbers.number(entry) for entry in getattr(table, key, None) or ()]
    if sizes and all(size == 0 for size in sizes):
        yield Finding("WG166", (*path, key), f"{key} has no direction: its entries are all 0", f"write {key} = [0, 0, 1], for instance")


def _pairs(path: Path, table: Table, numbers: Numbers) -> Iterator[Finding]:
    keys = tuple(type(table).model_fields) if isinstance(table, Domain) else _PAIRS
    for key in keys:
        pair = getattr(table, key, None)
        low, high = (numbers.number(entry) for entry in pair) if pair else (None, None)
        if low is not None and high is not None and low > high:
            message = f"{key} are crossed: {float(low):g} is more than {float(high):g}"
            yield Finding("WG160", (*path, key), message, f"write {key} = [{float(high):g}, {float(low):g}]")


def _bounds(name: str, entry: ParameterSpec, numbers: Numbers) -> Iterator[Finding]:
    low, high = (numbers.number(bound) for bound in entry.bounds) if entry.bounds else (None, None)
    value = numbers.values.get(name)
    if value is None or low is None or high is None or low > high:
        return
    if not float(low) <= value <= float(high):
        message = f"the value {value:g} lies outside its bounds [{float(low):g}, {float(high):g}]"
        yield Finding("WG163", ("parameters", name, "value"), message, "change the value or the bounds")


def check_inertias(spec: RobotSpec, numbers: Numbers) -> Iterator[Finding]:
    """Masses and inertias are those of a real body, unless the spec says that they are not."""
    for path, body in entries(spec):
        if isinstance(body, Link | PlatformSpec) and not body.allow_unphysical and (body.mass, body.inertia) != (None, None):
            yield from _inertia(path, body, numbers)


def _inertia(path: Path, body: Link | PlatformSpec, numbers: Numbers) -> Iterator[Finding]:
    mass = numbers.number(body.mass) if body.mass is not None else 0
    moments = [numbers.number(entry) for entry in body.inertia or (None,) * 6] if body.inertia else [0] * 6
    known = [moment for moment in moments if moment is not None]
    if mass is None or mass < 0 or len(known) < len(moments):
        return
    place = (*path, "inertia") if body.inertia else (*path, "mass")
    message = unphysical(mass, known)
    if message:
        cure = "mend it (ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, kg m^2), or write allow_unphysical = true"
        rests_on = tuple((*path, key) for key in ("mass", "inertia", "allow_unphysical"))
        yield Finding("WG162", place, message, cure, rests_on)


def unphysical(mass: Value, moments: Sequence[Value]) -> str:
    """What keeps the inertia from being a real body's, or nothing."""
    if not any(moments):
        return "a body with mass has an inertia" if mass else ""
    if mass == 0:
        return "a body without mass has no inertia"
    xx, yy, zz, xy, xz, yz = moments
    inertia = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
    if any(_minor(inertia, tuple(range(size))) <= 0 for size in (1, 2, 3)):
        return "the inertia is not positive definite"
    trace = xx + yy + zz
    # sums of squares of the body's extents: half the trace minus the inertia; not negative in any direction
    extents = tuple(tuple(trace / 2 * (row == column) - inertia[row][column] for column in range(3)) for row in range(3))
    if any(_minor(extents, rows) < -_TOLERANCE * trace ** len(rows) for size in (1, 2, 3) for rows in combinations(range(3), size)):
        return "the inertia breaks the triangle inequality: no principal moment is more than the sum of the other two"
    return ""


def _minor(matrix: Sequence[Sequence[Value]], rows: tuple[int, ...]) -> Value:
    """The determinant of the rows and columns named."""
    if not rows:
        return 1
    first, rest = rows[0], rows[1:]
    if not rest:
        return matrix[first][first]
    if len(rest) == 1:
        second = rest[0]
        return matrix[first][first] * matrix[second][second] - matrix[first][second] * matrix[second][first]
    a, b, c = matrix
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
