"""Functions of the whole robot in the first platform's frame: every platform's pose, every foot, every foot's Jacobian."""

from collections.abc import Callable, Sequence
from itertools import chain

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.driven import DrivenKinematics, kinematics_of
from walkgen.symbolic.footing import Footing, footing
from walkgen.symbolic.forward import flat, pose
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.soles import CONTACTS, EQ_CORNERS
from walkgen.symbolic.tape import IDENTITY, ZERO_VECTOR, Tape, Vec, symbols_of

_EQ_POSES = "eqs. (5)-(7): G_m = G_parent(m) B A_1 A_2 A_3 E"
_GROUND = Port("ground", (3,), default=(0.0, 0.0, 1.0))
_EQ_FEET = "eqs. (5)-(7): p = G_m M A_1 A_2 A_3 p_4"


class RobotFunctions:
    """Functions of the robot's q [nq]; they share one tape."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._q = joint_port("q", [joint for limb in mechanism.limbs for joint in limb.joints])
        self._tape = Tape()
        self._feet = [self._kinematics((*mechanism.ancestors(leg.platform), leg)) for leg in mechanism.legs]

    def _indices(self, limbs: Sequence[Limb]) -> list[int]:
        return list(chain.from_iterable(joint_indices(self._mechanism, limb) for limb in limbs))

    def _kinematics(self, limbs: Sequence[Limb]) -> Kinematics | DrivenKinematics:
        symbols = symbols_of(self._q)
        q = [symbols[index] for index in self._indices(limbs)]
        return kinematics_of(limbs, q, parameter_symbols(self._mechanism), self._tape)

    def _function(
        self, name: str, output: Port, outputs: Sequence[sympy.Expr], doc: str, source: str, more: Sequence[Port] = ()
    ) -> Function:
        return self._tape.function(signature(self._mechanism, "", name, [self._q, *more], [output], doc, source), outputs)

    def functions(self) -> dict[str, Callable[[], Function]]:
        """Those that the robot has: contacts apart from feet, and their normals, where a leg has a sole."""
        found = [self.platform_poses, self.foot_positions, self.foot_jacobians]
        found += [self.contact_points, self.contact_normals] if self._mechanism.contacts > len(self._mechanism.legs) else []
        return {function.__name__: function for function in found}

    def platform_poses(self) -> Function:
        """[m,4,4], the first the identity."""
        chains = [self._mechanism.ancestors(index) for index in range(len(self._mechanism.platforms))]
        paths = [self._kinematics(limbs) if limbs else None for limbs in chains]
        poses = [pose(path.rotation, path.position) if path else pose(IDENTITY, ZERO_VECTOR) for path in paths]
        port = Port("T", (len(poses), 4, 4), "1 and m")
        doc = "Pose of every platform in the first platform's frame."
        return self._function("platform_poses", port, list(chain.from_iterable(poses)), doc, _EQ_POSES)

    def foot_positions(self) -> Function:
        """[feet,3]."""
        positions = list(chain.from_iterable(foot.position for foot in self._feet))
        port = Port("p", (len(self._feet), 3), "m")
        return self._function("foot_positions", port, positions, "Every foot in the first platform's frame, legs in file order.", _EQ_FEET)

    @property
    def _footings(self) -> list[Footing]:
        return [footing(self._mechanism, leg, foot) for leg, foot in zip(self._mechanism.legs, self._feet, strict=True)]

    def contact_points(self) -> Function:
        """[k,3]."""
        points = [point for found in self._footings for point in found.points(self._tape)]
        port = Port("p", (len(points), 3), "m")
        return self._function("contact_points", port, list(chain.from_iterable(points)), CONTACTS, EQ_CORNERS)

    def contact_normals(self) -> Function:
        """[k,3]."""
        bare = any(leg.contacts == 1 for leg in self._mechanism.legs)
        ground = symbols_of(_GROUND)
        normals = [found.normal if len(found.levers) > 1 else ground for found in self._footings for _ in found.levers]
        port, doc = Port("n", (len(normals), 3)), "Unit normal of the sole at every one of contact_points, in the first platform's axes"
        doc += "; at feet without a sole that of the ground, which is given in these axes." if bare else "."
        more = [_GROUND] if bare else []
        return self._function("contact_normals", port, list(chain.from_iterable(normals)), doc, EQ_CORNERS, more)

    def foot_jacobians(self) -> Function:
        """[feet,3,nq]."""
        rows = chain.from_iterable(self._jacobian(foot, leg) for foot, leg in zip(self._feet, self._mechanism.legs, strict=True))
        port = Port("J", (len(self._feet), 3, self._q.size), f"m/({self._q.unit})")
        doc = "Jacobian of every foot position by all joints of the robot."
        return self._function("foot_jacobians", port, list(rows), doc, "J_i = D_i p along the foot's route")

    def _jacobian(self, foot: Kinematics | DrivenKinematics, leg: Limb) -> tuple[sympy.Expr, ...]:
        columns: list[Vec] = [ZERO_VECTOR] * self._q.size
        route = (*self._mechanism.ancestors(leg.platform), leg)
        for index, column in zip(self._indices(route), foot.jacobian, strict=True):
            columns[index] = column
        return flat(columns)


def joint_indices(mechanism: Mechanism, limb: Limb) -> range:
    """Where the limb's joints stand in the robot's q."""
    start = mechanism.offset(limb)
    return range(start, start + len(limb.joints))
