"""Compliance of locked legs and connecting chains: how far feet yield under forces, and under loads that chains carry (theory 4.3)."""

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from itertools import accumulate, chain, combinations_with_replacement

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.beams import Beam, Rows, all_have_sections
from walkgen.symbolic.driven import DrivenKinematics, kinematics_of
from walkgen.symbolic.footing import Footing, footing
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.linkage_beams import Yielding, yields_of
from walkgen.symbolic.path import Kinematics
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.robot import joint_indices
from walkgen.symbolic.tape import ZERO_VECTOR, Tape, Vec, cross, plus, symbols_of

Exprs = Sequence[sympy.Expr]
Blocks = dict[tuple[int, int], Rows]
"""3 by 3 blocks of a matrix over contact points."""
_SOURCE = "theory 4.3: C_i = sum of integrals of m_x m_x'/GJ + m_y m_y'/EIy + m_z m_z'/EIz, + L/EA along; exact Simpson rule"
_SHARED = "theory 4.3: C_ij over the links shared by the paths to both feet"
_HELD = "while the joints are locked and the platform is held; platform's axes"
_MISFIT = "theory 4.3: e_i += integral of sum_k m_k M_load,k over the chains"


def foot_compliance(mechanism: Mechanism, leg: Limb) -> Function | None:
    """C [3,3] of a leg with locked joints; None where a link of some length has no section."""
    if not all_have_sections(mechanism, leg):
        return None
    q, tape = joint_port("q", leg.joints), Tape()
    kinematics = kinematics_of((leg,), symbols_of(q), parameter_symbols(mechanism), tape)
    (beams,) = yields_of(mechanism, (leg,), kinematics)
    doc = f"How far the foot yields for a unit force on it {_HELD}."
    words = signature(mechanism, leg.name, "foot_compliance", [q], [Port("C", (3, 3), "m/N")], doc, _SOURCE)
    return tape.function(words, list(chain.from_iterable(_summed(beams, kinematics.position, kinematics.position, tape))))


def _summed(beams: Sequence[Yielding | None], first: Vec, second: Vec, tape: Tape) -> Rows:
    """Over the links; for one point the matrix is symmetric."""
    rows = _total([beam.shared(first, second, tape) for beam in beams if beam is not None], tape)
    if first == second:
        return [[rows[min(row, column)][max(row, column)] for column in range(3)] for row in range(3)]
    return rows


def sole_compliance(mechanism: Mechanism, leg: Limb) -> Function | None:
    """C [12,12] of a leg on its sole, [6,6] of a rolling one without width; None without one, or where a link has length and no section."""
    if leg.contacts == 1 or not all_have_sections(mechanism, leg):
        return None
    q, tape = joint_port("q", leg.joints), Tape()
    kinematics = kinematics_of((leg,), symbols_of(q), parameter_symbols(mechanism), tape)
    (beams,) = yields_of(mechanism, (leg,), kinematics)
    stands = footing(mechanism, leg, kinematics)
    blocks, size = _blocks(beams, stands, stands, tape), 3 * leg.contacts
    doc = (
        f"How far the sole's corners yield for unit forces on the corners {_HELD}: three rows and columns a corner, in the order of "
        "sole_points. A rigid sole has only six ways to move: without kn and kt in the spec the rank is at most 6, and the ground's "
        "compliance has to be added before it can be inverted."
    )
    words = signature(mechanism, leg.name, "sole_compliance", [q], [Port("C", (size, size), "m/N")], doc, _SHARED)
    return tape.function(words, [_entry(blocks, row, column) for row in range(size) for column in range(size)])


def _blocks(beams: Sequence[Yielding | None], first: Footing, second: Footing, tape: Tape) -> Blocks:
    """C_ij of every contact point i of one leg and j of another, or of the same one, over the links that their routes share.

    What is beyond the links is rigid: a point at r from a foot yields as that foot does, and by what the foot turns, crossed with r.
    """
    push = _summed(beams, first.foot, second.foot, tape)
    if (first.levers, second.levers) == ((ZERO_VECTOR,), (ZERO_VECTOR,)):
        return {(0, 0): push}
    bends = [beam for beam in beams if beam is not None]
    twist, back = (_total([beam.twisted(foot, tape) for beam in bends], tape) for foot in (first.foot, second.foot))
    turn = _total([beam.turned(tape) for beam in bends], tape)
    found: dict[tuple[int, int], Rows] = {}
    for j, arm in enumerate(second.levers):
        yields = [tape.vector("yield", plus(_vec(push[row]), cross(_vec(twist[row]), arm))) for row in range(3)]
        turns = [tape.vector("turn", plus(_column(back, row), cross(_vec(turn[row]), arm))) for row in range(3)]
        for i, lever in enumerate(first.levers):
            by_turn = [cross(_column(turns, column), lever) for column in range(3)]
            found[i, j] = [[tape.let("c", yields[row][column] + by_turn[column][row]) for column in range(3)] for row in range(3)]
    return _padded(found, first, tape) if first is second else found


def _padded(blocks: Blocks, stands: Footing, tape: Tape) -> Blocks:
    """With the sole's pad under each corner, n n'/kn + (1 - n n')/kt."""
    (along, across), n = stands.pad, stands.normal
    if along == across == 0:
        return blocks
    more = tape.let("pad_more", along - across)
    pad = [[more * n[row] * n[column] + (across if row == column else 0) for column in range(3)] for row in range(3)]
    corners = {(i, i): blocks[i, i] for i in range(len(stands.levers))}
    return blocks | {place: _total((block, pad), tape) for place, block in corners.items()}


def _entry(blocks: Blocks, row: int, column: int) -> sympy.Expr:
    """Of the whole matrix, which is symmetric: its upper triangle."""
    low, high = sorted((row, column))
    return blocks[low // 3, high // 3][low % 3][high % 3]


def _total(parts: Sequence[Rows], tape: Tape) -> Rows:
    return [[tape.let("c", sympy.Add(*(part[row][column] for part in parts))) for column in range(3)] for row in range(3)]


def _column(rows: Sequence[Sequence[sympy.Expr]], column: int) -> Vec:
    return _vec([row[column] for row in rows])


class StanceCompliance:
    """The robot's feet on its legs and connecting chains, all joints locked, the first platform held; functions share a tape."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism, self._tape = mechanism, Tape()
        self._q = joint_port("q", [joint for limb in mechanism.limbs for joint in limb.joints])
        self._routes = [(*mechanism.ancestors(leg.platform), leg) for leg in mechanism.legs]

    def functions(self) -> dict[str, Callable[[], Function]]:
        """Those that the robot has: sections of all legs; the loads' misfit takes those of chains as well, rigid links left out."""
        if not all(all_have_sections(self._mechanism, leg) for leg in self._mechanism.legs):
            return {}
        found: dict[str, Callable[[], Function]] = {"stance_compliance": self.stance_compliance}
        if any(joint.section for limb in self._mechanism.chains for joint in limb.joints):
            found["load_misfit"] = self.load_misfit
        return found

    @cached_property
    def _feet(self) -> list[Kinematics | DrivenKinematics]:
        return [self._kinematics(route) for route in self._routes]

    @cached_property
    def _beams(self) -> list[dict[int, tuple[Yielding | None, ...]]]:
        """For every foot, the beams of each limb on its route, by the limb's place among the limbs."""
        found = [yields_of(self._mechanism, route, foot) for route, foot in zip(self._routes, self._feet, strict=True)]
        places = [map(self._mechanism.limbs.index, route) for route in self._routes]
        return [dict(zip(limbs, beams, strict=True)) for limbs, beams in zip(places, found, strict=True)]

    @property
    def _places(self) -> str:
        """What a row or a row of blocks belongs to."""
        soles = any(leg.sole for leg in self._mechanism.legs)
        return "contact point, as contact_points has them" if soles else "foot, legs in file order"

    def _kinematics(self, limbs: Sequence[Limb]) -> Kinematics | DrivenKinematics:
        symbols = symbols_of(self._q)
        indices = chain.from_iterable(joint_indices(self._mechanism, limb) for limb in limbs)
        return kinematics_of(limbs, [symbols[index] for index in indices], parameter_symbols(self._mechanism), self._tape)

    def stance_compliance(self) -> Function:
        """[3k,3k]."""
        count, blocks = self._mechanism.contacts, self._blocks()
        entries = [_entry(blocks, row, column) for row in range(3 * count) for column in range(3 * count)]
        port = Port("C", (3 * count, 3 * count), "m/N")
        doc = (
            "How far the feet yield for unit forces on the feet while the joints are locked and the first platform is held: three rows and "
            f"columns a {self._places}, first platform's axes. Links of chains without a section are rigid."
        )
        return self._function("stance_compliance", [self._q], port, entries, doc, _SHARED)

    def _blocks(self) -> Blocks:
        """By contact points, the first before the second."""
        legs, found = self._mechanism.legs, dict[tuple[int, int], Rows]()
        starts = list(accumulate((leg.contacts for leg in legs), initial=0))
        for first, second in combinations_with_replacement(range(len(legs)), 2):
            blocks = self._between(first, second)
            found |= {(starts[first] + i, starts[second] + j): block for (i, j), block in blocks.items()}
        return found

    def _between(self, first: int, second: int) -> Blocks:
        """C_ij of two legs' contact points; of one, over its whole route."""
        beams = chain.from_iterable(links for limb, links in self._beams[first].items() if limb in self._beams[second])
        stands = self._footing(first)
        return _blocks(tuple(beams), stands, stands if first == second else self._footing(second), self._tape)

    def _footing(self, foot: int) -> Footing:
        return footing(self._mechanism, self._mechanism.legs[foot], self._feet[foot])

    def load_misfit(self) -> Function:
        """[k,3]."""
        loads = Port("loads", (len(self._mechanism.platforms), 6), "N and N m")
        symbols = symbols_of(loads)
        wrenches = [(_vec(symbols[start : start + 3]), _vec(symbols[start + 3 : start + 6])) for start in range(0, len(symbols), 6)]
        feet = range(len(self._feet))
        moved = [self._moved(foot, point, wrenches) for foot in feet for point in self._footing(foot).points(self._tape)]
        port = Port("e", (len(moved), 3), "m")
        doc = (
            "How far the feet move under loads on the platforms while the joints are locked and the first platform is held: a row a "
            f"{self._places}; loads are force and moment about the first platform's origin, in its axes."
        )
        return self._function("load_misfit", [self._q, loads], port, list(chain.from_iterable(moved)), doc, _MISFIT)

    def _moved(self, foot: int, point: Vec, wrenches: Sequence[tuple[Vec, Vec]]) -> Vec:
        """By every elastic link of the chains to the foot, under the loads beyond it."""
        total = ZERO_VECTOR
        for limb in self._routes[foot][:-1]:
            force, moment = self._beyond(limb, wrenches)
            for beam in self._beams[foot][self._mechanism.limbs.index(limb)]:
                if isinstance(beam, Beam):
                    total = self._tape.vector("misfit", plus(total, beam.under(point, force, moment, self._tape)))
        return total

    def _beyond(self, limb: Limb, wrenches: Sequence[tuple[Vec, Vec]]) -> tuple[Vec, Vec]:
        """The loads on the platforms that a chain carries."""
        force, moment = ZERO_VECTOR, ZERO_VECTOR
        for platform in carried_platforms(self._mechanism, limb):
            force = self._tape.vector("carried_force", plus(force, wrenches[platform][0]))
            moment = self._tape.vector("carried_moment", plus(moment, wrenches[platform][1]))
        return force, moment

    def _function(self, name: str, inputs: Sequence[Port], output: Port, outputs: Exprs, doc: str, source: str) -> Function:
        return self._tape.function(signature(self._mechanism, "", name, inputs, [output], doc, source), outputs)


def carried_platforms(mechanism: Mechanism, limb: Limb) -> Iterator[int]:
    """The platforms beyond a connecting chain."""
    return (index for index in range(len(mechanism.platforms)) if limb in mechanism.ancestors(index))


def _vec(components: Sequence[sympy.Expr]) -> Vec:
    x, y, z = components
    return (x, y, z)
