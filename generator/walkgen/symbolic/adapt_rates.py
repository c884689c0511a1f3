"""`adapt_velocity` of robots whose legs have linkages: at a posture such a leg moves its foot as three slides along its Jacobian's columns
would, so that the routine for joints in series serves.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

import sympy

from walkgen.model.mechanism import Joint, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.driven import DrivenKinematics, kinematics_of
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Solve, Step
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.robot import joint_indices
from walkgen.symbolic.rows import parameters_of
from walkgen.symbolic.screws import limits_of, limits_port
from walkgen.symbolic.tape import ZERO_VECTOR, Tape, Vec, cross, minus, symbols_of

Exprs = Sequence[sympy.Expr]
_NOTHING = (*ZERO_VECTOR, *ZERO_VECTOR)


@dataclass(frozen=True)
class Posture:
    """The robot where it stands, as the routine takes it: at joint values that all are 0.

    Attributes:
        mechanism: connecting chains, and legs of three q.
        tree: the port of its numbers, `topology` that of who carries whom, as `adapt` has them.
    """

    mechanism: Mechanism
    tree: Port
    topology: Port

    @property
    def joints(self) -> tuple[Joint, ...]:
        """All of them, in the order of q."""
        return tuple(joint for limb in self.mechanism.limbs for joint in limb.joints)

    @property
    def kept(self) -> tuple[Port, ...]:
        """What `steps` fill."""
        return (self.tree, self.topology, limits_port(self.joints), Port("still", (len(self.joints),)))

    def solve(self, words: Signature, topology: Exprs, step: Step) -> Solve:
        """What describes the posture q, then the routine."""
        own = signature(self.mechanism, "", "posture", [joint_port("q", self.joints)], self.kept, "The robot where it stands.", "")
        tape = Tape()
        outputs = [*self._tree(tape), *self._kinds(topology), *self._limits(), *(sympy.S.Zero for _ in self.joints)]
        described = Step(tape.function(own, outputs), ("q", *parameters_of(self.mechanism), *(port.name for port in self.kept)))
        return Solve(words, self.kept, (described, step))

    def _tree(self, tape: Tape) -> Iterator[sympy.Expr]:
        """Axis and point of every joint, then the feet; platforms do not matter."""
        mechanism, symbols = self.mechanism, symbols_of(joint_port("q", self.joints))
        rows, feet = dict.fromkeys(range(len(self.joints)), _NOTHING), []
        for leg in mechanism.legs:
            limbs = (*mechanism.ancestors(leg.platform), leg)
            places = [place for limb in limbs for place in joint_indices(mechanism, limb)]
            path = kinematics_of(limbs, [symbols[place] for place in places], parameter_symbols(mechanism), tape)
            own = len(places) - len(leg.joints)
            for number, place in enumerate(places):
                rows[place] = self._chain_joint(path, number, tape) if number < own else (*path.jacobian[number], *ZERO_VECTOR)
            feet.append(path.position)
        yield from chain.from_iterable(rows[place] for place in range(len(self.joints)))
        yield from chain.from_iterable(feet)
        yield from (sympy.S.Zero for _ in range(12 * len(mechanism.platforms)))

    def _chain_joint(self, path: Kinematics | DrivenKinematics, number: int, tape: Tape) -> tuple[sympy.Expr, ...]:
        """Its axis, and the point on it that is nearest to the foot: v = z x (p - o), and so p - o = v x z."""
        column, axis = path.jacobian[number], path.angular[number]
        if axis == ZERO_VECTOR:
            return (*column, *ZERO_VECTOR)
        point: Vec = tape.vector("on_axis", minus(path.position, cross(column, axis)))
        return (*axis, *point)

    def _kinds(self, topology: Exprs) -> Exprs:
        """Every joint of a leg slides."""
        count, chains = len(self.joints), sum(len(limb.joints) for limb in self.mechanism.chains)
        return (*topology[: count + chains], *(sympy.S.One for _ in range(count - chains)), *topology[2 * count :])

    def _limits(self) -> Iterator[sympy.Expr]:
        """Half a turn either way where a leg's joint turns without limits: as much as the routine takes for turning joints."""
        parameters = parameter_symbols(self.mechanism)
        for limb in self.mechanism.limbs:
            for joint in limb.joints:
                free = limb.child is None and joint.kind == "revolute" and joint.limits is None
                yield from (-sympy.pi, sympy.pi) if free else limits_of(joint, parameters)
