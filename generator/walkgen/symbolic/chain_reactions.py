"""What every pair of the connecting chains carries of the feet's forces and the platforms' loads: statics of the part beyond it."""

from collections.abc import Callable, Iterator, Sequence
from itertools import chain

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.beams import links_of
from walkgen.symbolic.compliance import carried_platforms
from walkgen.symbolic.driven import kinematics_of
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.path import Kinematics, path_of
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.robot import joint_indices
from walkgen.symbolic.tape import ZERO_VECTOR, Tape, Vec, minus, plus, symbols_of, times
from walkgen.symbolic.wrench import Wrench


def chain_reactions(mechanism: Mechanism) -> dict[str, Callable[[], Function]]:
    """Where the robot has joints in connecting chains."""
    if not any(limb.joints for limb in mechanism.chains):
        return {}
    return {"chain_reactions": lambda: _Reactions(mechanism).function()}


class _Reactions:
    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism, self._tape = mechanism, Tape()
        self._q = joint_port("q", [joint for limb in mechanism.limbs for joint in limb.joints])
        self._forces = Port("foot_forces", (len(mechanism.legs), 3), "N")
        self._loads = Port("loads", (len(mechanism.platforms), 6), "N and N m")

    def function(self) -> Function:
        """[chain joints, 6]."""
        rows = [row for limb in self._mechanism.chains for row in self._through(limb)]
        doc = (
            "What every joint of the connecting chains carries, chains in file order: force and moment about the joint that all beyond it "
            "exerts on all before it, first platform's axes, nothing moving. foot_forces are the ground's on the feet, loads those on the "
            "platforms (weights too) with moments about the first platform's origin, all in its axes."
        )
        port, inputs = Port("reactions", (len(rows), 6), "N and N m"), [self._q, self._forces, self._loads]
        words = signature(self._mechanism, "", "chain_reactions", inputs, [port], doc, "equilibrium of the part beyond the joint")
        return self._tape.function(words, list(chain.from_iterable(rows)))

    def _through(self, limb: Limb) -> Iterator[tuple[sympy.Expr, ...]]:
        carried = self._beyond(limb)
        for joint, point in zip(limb.joints, self._stands(limb), strict=True):
            about = carried.seen_from(minus(ZERO_VECTOR, point)).named(self._tape, f"{limb.name}_{joint.name}")
            yield (*about.force, *about.moment)

    def _beyond(self, limb: Limb) -> Wrench:
        """Of the feet and platforms beyond a chain, about the first platform's origin."""
        total, loads, forces = Wrench(), symbols_of(self._loads), symbols_of(self._forces)
        for platform in carried_platforms(self._mechanism, limb):
            load = loads[6 * platform : 6 * platform + 6]
            total = (total + Wrench(_vec(load[:3]), _vec(load[3:]))).named(self._tape, f"{limb.name}_load")
        for foot, leg in enumerate(self._mechanism.legs):
            route = (*self._mechanism.ancestors(leg.platform), leg)
            if limb in route:
                push = Wrench(_vec(forces[3 * foot : 3 * foot + 3])).seen_from(self._foot(route))
                total = (total + push).named(self._tape, f"{limb.name}_with_{leg.name}")
        return total

    def _stands(self, limb: Limb) -> Iterator[Vec]:
        """Where the chain's joints stand in the first platform's frame."""
        assert limb.child is not None
        limbs, parameters = self._mechanism.ancestors(limb.child), parameter_symbols(self._mechanism)
        kinematics = Kinematics(path_of(limbs, self._values(limbs), parameters), self._tape)
        own, values = kinematics.frames[-len(limb.joints) :], kinematics.path.q[-len(limb.joints) :]
        links = links_of(limb, values, parameters)
        for joint, (columns, origin), link in zip(limb.joints, own, links, strict=True):
            yield self._tape.vector(f"{limb.name}_{joint.name}_stand", plus(origin, times(columns, link.near)))

    def _foot(self, route: Sequence[Limb]) -> Vec:
        return kinematics_of(route, self._values(route), parameter_symbols(self._mechanism), self._tape).position

    def _values(self, limbs: Sequence[Limb]) -> list[sympy.Symbol]:
        """The joint values of limbs."""
        symbols = symbols_of(self._q)
        return [symbols[index] for limb in limbs for index in joint_indices(self._mechanism, limb)]


def _vec(components: Sequence[sympy.Expr]) -> Vec:
    x, y, z = components
    return (x, y, z)
