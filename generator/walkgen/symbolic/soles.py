"""Where legs touch the ground: the foot point, or the corners of a sole about it, and the pressure under a rectangular one."""

from collections.abc import Callable, Sequence
from itertools import chain

import sympy

from walkgen.model.mechanism import CORNERS, Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.driven import kinematics_of
from walkgen.symbolic.footing import Footing, footing
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.tape import Tape, dot, symbols_of

ORDER = "the corners (+,+), (-,+), (-,-), (+,-) in the sole's x and y"
_SOLE = "the sole's x runs along its length, y along its width, z away from the ground"
_ROLLING = (
    "Where a rolling sole touches the ground, in the platform's frame: the front and the rear edge of its flat part where that lies on the "
    "ground (to 1e-9 rad), else twice the line on which it rolls"
)
_ONCE_ROUND = "; ends of these lines once round: front, rear, rear, front, those towards the foot frame's z first"
EQ_ROLLING = "theory 8.1, 8.3"
EQ_CORNERS = "eq. (1) with p_n at the corner"
CONTACTS = (
    f"Where the robot touches the ground, in the first platform's frame, legs in file order: of a leg with a sole {ORDER}, of one with a "
    "rolling sole sole_points, else the foot."
)
_UP = (0.0, 0.0, 1.0)


class SoleFunctions:
    """Functions of a leg that stands on a sole; they share one tape."""

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        self._mechanism, self._leg, self._tape = mechanism, leg, Tape()
        self._q = joint_port("q", leg.joints)
        self._parameters = parameter_symbols(mechanism)

    def functions(self) -> dict[str, Callable[[], Function]]:
        """None of a leg that stands on its foot point."""
        if self._leg.curved_sole is not None:
            return {"sole_points": self.rolling_points, "sole_normal": self.ground_normal}
        if self._leg.sole is None:
            return {}
        return {"sole_points": self.sole_points, "sole_normal": self.sole_normal, "ground_pressure": self.ground_pressure}

    def _footing(self) -> Footing:
        return footing(self._mechanism, self._leg, kinematics_of((self._leg,), symbols_of(self._q), self._parameters, self._tape))

    def sole_points(self) -> Function:
        """[4,3]."""
        corners = list(chain.from_iterable(self._footing().points(self._tape)))
        doc = f"Corners of the sole in the platform's frame, once round: {ORDER}; {_SOLE}."
        return self._function("sole_points", (self._q,), (Port("p", (len(CORNERS), 3), "m"),), corners, doc, EQ_CORNERS)

    def sole_normal(self) -> Function:
        """[3]."""
        doc = "Unit normal of the sole, away from the ground, in the platform's axes: its z."
        return self._function("sole_normal", (self._q,), (Port("n", (3,)),), self._footing().normal, doc, EQ_CORNERS)

    def rolling_points(self) -> Function:
        """[4,3], [2,3] without a width."""
        points = self._footing().points(self._tape)
        doc = f"{_ROLLING}{_ONCE_ROUND if len(points) == len(CORNERS) else ''}."
        return self._function("sole_points", (self._q,), (Port("p", (len(points), 3), "m"),), [*chain(*points)], doc, EQ_ROLLING)

    def ground_normal(self) -> Function:
        """[3]."""
        doc = "Unit normal of the ground under a rolling sole, in the platform's axes."
        return self._function("sole_normal", (self._q,), (Port("n", (3,)),), self._footing().normal, doc, EQ_ROLLING)

    def ground_pressure(self) -> Function:
        """Mean pressure and its centre, out of the corners' forces in any one frame."""
        assert self._leg.sole is not None
        forces, normal = Port("f", (len(CORNERS), 3), "N"), Port("normal", (3,), default=_UP)
        values, up = symbols_of(forces), symbols_of(normal)
        normals = [self._tape.let("N", dot(values[3 * corner : 3 * corner + 3], up)) for corner in range(len(CORNERS))]
        total = self._tape.let("total", sympy.Add(*normals))
        length, width = (expression(size, self._parameters) for size in (self._leg.sole.length, self._leg.sole.width))
        weighted = [sympy.Add(*(corner[axis] * N for corner, N in zip(CORNERS, normals, strict=True))) for axis in range(2)]
        centre = [size / 2 * part / total for size, part in zip((length, width), weighted, strict=True)]
        outputs = (Port("pressure", (), "Pa"), Port("centre", (2,), "m"))
        doc = (
            "Mean pressure under the sole and the centre of pressure along its x and y, NaN where nothing presses: f are the ground's "
            "forces on the corners in the order of sole_points, normal the unit normal away from the ground, both in any one frame."
        )
        found = [total / (length * width), *centre]
        return self._function("ground_pressure", (forces, normal), outputs, found, doc, "sum N / (length width), sum N c / sum N")

    def _function(
        self, name: str, inputs: Sequence[Port], outputs: Sequence[Port], found: Sequence[sympy.Expr], doc: str, source: str
    ) -> Function:
        return self._tape.function(signature(self._mechanism, self._leg.name, name, inputs, outputs, doc, source), found)
