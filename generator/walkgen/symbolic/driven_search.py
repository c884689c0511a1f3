"""Searches in the drives of a leg that ends in a linkage: within the limits closest to a target, or near a seed where no rows are known."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Port, Signature
from walkgen.symbolic.closing import called_back
from walkgen.symbolic.driven import DrivenKinematics
from walkgen.symbolic.forward import Route
from walkgen.symbolic.frames import expression, frame_of, parameter_symbols
from walkgen.symbolic.function import Solve, Step
from walkgen.symbolic.limits import ADMISSIBLE_DOC, STATUS, middle
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.reach import iterated
from walkgen.symbolic.rows import TARGET, parameters_of
from walkgen.symbolic.screws import limits_of, limits_port, sequence_of
from walkgen.symbolic.tape import Tape, Vec, dot, symbols_of

_REACH = Port("reach", (), "m")
_MOST_EDGES = 4
_SOURCE = "Levenberg-Marquardt and Newton's method with exact derivatives of the placed linkage, from several starts"


def inverse_driven(mechanism: Mechanism, route: Route) -> Solve:
    """`inverse_near` of a route to a linkage's foot without rows."""
    seed, q = joint_port("q_seed", route.joints), joint_port("q", route.joints)
    doc = "Joint values near q_seed that bring the foot to p, within the limits if possible; the best found where nothing does."
    words = signature(mechanism, route.owner, "inverse_near", [TARGET, seed], [q, STATUS], doc, _SOURCE)
    searched = DrivenSearch(mechanism, route)
    arguments = ("p", "q_seed", "limits", "reach", searched.sequence, searched.edges, searched.motion.signature.full_name, "q", "status")
    steps = (searched.bounds, Step("wg_inverse_driven", arguments))
    linkage = route.limbs[-1].linkage
    followed = linkage is not None and linkage.forward.triads
    return Solve(
        words, searched.ports, steps, None if followed else iterated(mechanism, route, TARGET, words), callbacks=(searched.motion,)
    )


def admissible_driven(mechanism: Mechanism, leg: Limb) -> Solve:
    """`inverse_admissible` of a leg without rows."""
    searched = DrivenSearch(mechanism, Route(leg.name, (leg,)))
    guess = Step(middle(mechanism, leg), (*parameters_of(mechanism), "q", "status"))
    return Solve(admissible_words(mechanism, leg), searched.ports, (searched.bounds, guess, searched.closest), callbacks=(searched.motion,))


def admissible_words(mechanism: Mechanism, leg: Limb) -> Signature:
    """Of `inverse_admissible`."""
    return signature(
        mechanism, leg.name, "inverse_admissible", [TARGET], [joint_port("q", leg.joints), STATUS], ADMISSIBLE_DOC, "as inverse"
    )


@dataclass(frozen=True)
class DrivenSearch:
    """What searches along one route are made of."""

    mechanism: Mechanism
    route: Route

    @property
    def sequence(self) -> int:
        """The joints' kinds."""
        return sequence_of(self.route.joints)

    @property
    def ports(self) -> tuple[Port, Port]:
        """What `bounds` fills."""
        return limits_port(self.route.joints), _REACH

    @property
    def bounds(self) -> Step:
        """The limits, and about how far the foot gets from the base."""
        tape = Tape()
        limits = [bound for joint in self.route.joints for bound in self._limits(joint)]
        words = signature(self.mechanism, self.route.owner, "search_bounds", [], self.ports, "", "")
        return Step(tape.function(words, [*limits, self.reach]), (*parameters_of(self.mechanism), *(port.name for port in self.ports)))

    @property
    def reach(self) -> sympy.Expr:
        """About how far the foot gets from the base."""
        linkage = self.route.limbs[-1].linkage
        assert linkage is not None
        lengths = [sympy.sqrt(dot(way, way)) for way in self._ways()]
        return 2 * expression(linkage.size, parameter_symbols(self.mechanism)) + sympy.Add(*lengths)

    @property
    def closest(self) -> Step:
        """From the guess in q."""
        arguments = ("p", "limits", "reach", self.sequence, self.edges, self.motion.signature.full_name, "q", "status")
        return Step("wg_closest_driven", arguments, ("wg_any_unreachable", ("status", 1)))

    @property
    def nearer(self) -> Step:
        """The solution in q, or one that is nearer to the seed."""
        given = ("p", "q_seed", "limits", "reach", self.sequence, self.edges, self.motion.signature.full_name)
        return Step("wg_nearer_driven", (*given, "q", "status"))

    def within(self, rows: str, states: str, slots: int) -> tuple[Step, ...]:
        """The row that fits the limits best; where none does, what comes closest."""
        chosen = Step("wg_admissible_row", (rows, states, "limits", self.sequence, slots, "q", "status"))
        return (self.bounds, chosen, self.closest)

    @property
    def edges(self) -> int:
        """How many margins the routines are told."""
        count = len(self.route.joints)
        return self.motion.signature.outputs[0].size // (1 + count + count**2) - 3

    @cached_property
    def motion(self) -> Solve:
        """The foot and margins with their derivatives, as the routines call it."""
        return self._motion("motion", _MOST_EDGES)

    @cached_property
    def foot(self) -> Solve:
        """The foot alone with its derivatives."""
        return self._motion("foot", 0)

    def _motion(self, name: str, most: int) -> Solve:
        """With so many margins at the most."""
        port, tape = joint_port("q", self.route.joints), Tape()
        linkage = self.route.limbs[-1].linkage
        assert linkage is not None
        kinematics = DrivenKinematics(self.route.limbs, linkage, symbols_of(port), parameter_symbols(self.mechanism), tape)
        count = len(self.route.joints)
        seconds = {pair: kinematics.second(*pair) for pair in ((i, j) for j in range(count) for i in range(j + 1))}
        margins = kinematics.margins(most)
        values = [*kinematics.position, *(value for value, _, _ in margins)]
        values += [column[row] for row in range(3) for column in kinematics.jacobian]
        values += [slope for _, slopes, _ in margins for slope in slopes]
        values += [seconds[min(i, j), max(i, j)][row] for row in range(3) for i in range(count) for j in range(count)]
        values += [bend for _, _, bends in margins for row in bends for bend in row]
        words = signature(self.mechanism, self.route.owner, f"{name}_at", [port], [Port("motion", (len(values),))], "", "")
        return called_back(tape.function(words, values), name)

    def _limits(self, joint: Joint) -> tuple[sympy.Expr, sympy.Expr]:
        """A cylinder is never shorter than nothing."""
        least, greatest = limits_of(joint, parameter_symbols(self.mechanism))
        leg = self.route.limbs[-1]
        cylinders = leg.drives[len(leg.linkage.driven) :] if leg.linkage else ()
        return (sympy.S.Zero if joint in cylinders and joint.limits is None else least), greatest

    def _ways(self) -> Iterator[Vec]:
        """What the constant poses along the route shift."""
        parameters = parameter_symbols(self.mechanism)
        for limb in self.route.limbs:
            series = (pose for joint in (*limb.serial, *limb.distal) for pose in (joint.before, joint.after))
            poses = (limb.mount, limb.tip, limb.foot, *series)
            yield from (frame_of(pose, parameters).origin for pose in poses)
