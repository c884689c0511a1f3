"""Functions of one leg's dynamics: their ports, builders and words."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import sympy

from walkgen.model.mechanism import Joint, Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.driven_motions import NoPostureError
from walkgen.symbolic.drives import effort_unit
from walkgen.symbolic.function import Function
from walkgen.symbolic.leg_dynamics import (
    LegDynamics,
    base_parameters,
    bias,
    coriolis_matrix,
    forward_dynamics,
    gravity_torque,
    inverse_dynamics,
    inverse_dynamics_derivatives,
    kinetic_energy,
    mass_matrix,
    potential_energy,
    regressor,
)
from walkgen.symbolic.linked_tree import spread_leg
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.regroup import regrouped
from walkgen.symbolic.spread import Spread
from walkgen.symbolic.spring_functions import spring_energy, spring_length, spring_moment, spring_tension, unbalance_moment
from walkgen.symbolic.tape import Tape, symbols_of
from walkgen.symbolic.tree import Tree
from walkgen.symbolic.triangular import SingularMatrixError

Exprs = Sequence[sympy.Expr]
Ports = Callable[[Sequence[Joint], int], tuple[Port, ...]]
"""Outputs of a leg with these joints, that have so many elements together."""


@dataclass(frozen=True)
class Entry:
    """One generated function of a leg: names of the inputs, outputs, builder of all outputs' elements, words.

    `by_value` lets the inertias' own numbers simplify the leg.
    """

    inputs: tuple[str, ...]
    outputs: Ports
    build: Callable[[LegDynamics], Exprs]
    doc: str
    source: str
    by_value: bool = True


def _mass_unit(joints: Sequence[Joint]) -> str:
    kinds = frozenset(joint.kind for joint in joints)
    return {frozenset({"revolute"}): "kg m^2", frozenset({"prismatic"}): "kg"}.get(kinds, "kg m^2, kg m or kg")


def _one(name: str, rank: int, unit: Callable[[Sequence[Joint]], str]) -> Ports:
    """A number, vector or matrix over the joints."""
    return lambda joints, _: (Port(name, (len(joints),) * rank, unit(joints)),)


def _each(name: str, unit: str) -> Ports:
    """A number for every spring."""
    return lambda _, elements: (Port(name, (elements,), unit),)


_PER_PARAMETER = "effort per unit of the parameter"
_HELD = "the platform is held, gravity is the spec's in the platform's axes"
_NEWTON_EULER = "recursive Newton-Euler (Luh, Walker, Paul 1980) with regrouped inertial parameters"
_EULER = "composite rigid bodies (Walker and Orin 1982) with regrouped inertial parameters"
_FORCE = "f is the ground's force on the foot, in the platform's axes"

DYNAMICS: dict[str, Entry] = {
    "inverse_dynamics": Entry(
        ("q", "qd", "qdd", "f"),
        _one("tau", 1, effort_unit),
        inverse_dynamics,
        f"Joint efforts of a motion, M qdd + C qd + gravity + friction - J' f; {_HELD}, {_FORCE}.",
        _NEWTON_EULER,
    ),
    "forward_dynamics": Entry(
        ("q", "qd", "tau", "f"),
        lambda joints, _: (joint_port("qdd", joints, "/s^2"),),
        forward_dynamics,
        f"Joint accelerations of efforts tau; {_HELD}, {_FORCE}.",
        f"{_EULER}, then L' D L (Featherstone 2005)",
    ),
    "mass_matrix": Entry(("q",), _one("M", 2, _mass_unit), mass_matrix, "Mass matrix, rotors included.", _EULER),
    "bias": Entry(
        ("q", "qd"),
        _one("h", 1, effort_unit),
        bias,
        f"Joint efforts without acceleration, C qd + gravity + friction; {_HELD}.",
        _NEWTON_EULER,
    ),
    "gravity_torque": Entry(("q",), _one("g", 1, effort_unit), gravity_torque, f"Joint efforts that hold the leg; {_HELD}.", _NEWTON_EULER),
    "coriolis_matrix": Entry(
        ("q", "qd"),
        _one("C", 2, lambda joints: f"{effort_unit(joints)} s"),
        coriolis_matrix,
        "Coriolis matrix of Christoffel symbols: dM/dt - 2 C is skew; friction is left out.",
        "composite bodies with moments of their velocities (after Echeandia and Wensing 2021)",
    ),
    "kinetic_energy": Entry(
        ("q", "qd"),
        _one("T", 0, lambda _: "J"),
        kinetic_energy,
        "Kinetic energy, rotors included; the platform is held.",
        "sum of p . v / 2",
    ),
    "potential_energy": Entry(
        ("q",),
        _one("U", 0, lambda _: "J"),
        potential_energy,
        "Potential energy of gravity, 0 for masses at the platform's origin; gravity is the spec's in the platform's axes.",
        "U = - m g . c",
    ),
    "inverse_dynamics_derivatives": Entry(
        ("q", "qd", "qdd"),
        lambda joints, _: (
            Port("tau_d_q", (len(joints), len(joints)), f"{effort_unit(joints)} per {joint_port('q', joints).unit}"),
            Port("tau_d_qd", (len(joints), len(joints)), f"{effort_unit(joints)} per {joint_port('q', joints, '/s').unit}"),
        ),
        inverse_dynamics_derivatives,
        f"Slopes of inverse_dynamics by q and by qd at no foot force (by qdd it is mass_matrix); row i is the effort's; {_HELD}.",
        "forward differentiation of recursive Newton-Euler",
    ),
    "regressor": Entry(
        ("q", "qd", "qdd"),
        lambda joints, elements: (Port("Y", (len(joints), elements // len(joints)), _PER_PARAMETER),),
        regressor,
        "Joint efforts per inertial parameter: for every link m, m cx, m cy, m cz, then xx, yy, zz, xy, xz, yz of its inertia about the "
        "origin of its joint's frame, in that frame's axes; friction and rotors are left out.",
        "recursive Newton-Euler of unit parameters",
    ),
    "base_parameters": Entry(
        ("q", "qd", "qdd"),
        lambda joints, elements: (
            Port("Y", (len(joints), elements // (len(joints) + 1)), _PER_PARAMETER),
            Port("p", (elements // (len(joints) + 1),), "kg, kg m and kg m^2"),
        ),
        base_parameters,
        "The fewest inertial parameters p that joint efforts depend on, as the spec has them, and the efforts' regressor Y: Y p is "
        "inverse_dynamics without friction and rotors. p depends on the spec and param alone; each is a sum over links.",
        "Gautier and Khalil 1990, numerically confirmed at 50 digits",
        by_value=False,
    ),
}

SPRUNG: dict[str, Entry] = {
    "spring_length": Entry(
        ("q",), _each("length", "m"), spring_length, "Length of every spring. In order: {springs}.", "the distance of its ends"
    ),
    "spring_tension": Entry(
        ("q",),
        _each("tension", "N"),
        spring_tension,
        "What every spring pulls its ends together with: initial tension + stiffness (length - free length), which below the free length "
        "is not what a real one does. In order: {springs}.",
        "T = F0 + k (l - l0)",
    ),
    "spring_energy": Entry(
        ("q",),
        _each("U", "J"),
        spring_energy,
        "Energy in every spring, 0 at its free length. In order: {springs}.",
        "U = F0 (l - l0) + k (l - l0)^2 / 2",
    ),
    "spring_moment": Entry(
        ("q",),
        lambda joints, elements: (Port("moment", (elements // len(joints), len(joints)), effort_unit(joints)),),
        spring_moment,
        "What every spring does to every joint, positive where it drives q on: minus the slope of its energy. Rows: {springs}.",
        "eq. (21) of the chapter as corrected: M = T BF sin(angle between BF and the spring)",
    ),
    "unbalance_moment": Entry(
        ("q", "load"),
        _one("moment", 1, effort_unit),
        unbalance_moment,
        "What springs and gravity, of the leg and of a load that the foot carries, do to every joint at rest: positive where they drive q "
        f"on, 0 where the leg is balanced; {_HELD}.",
        "eq. (21) of the chapter as corrected",
    ),
}
"""Functions of legs with springs."""

_OF_SPRINGS = {
    **dict.fromkeys(("inverse_dynamics", "forward_dynamics", "bias", "gravity_torque"), " Its springs pull."),
    "inverse_dynamics_derivatives": " Its springs pull.",
    "potential_energy": " Springs count, 0 at their free lengths.",
    **dict.fromkeys(("regressor", "base_parameters"), " Springs are left out, but for what they weigh."),
}
"""What there is to say of dynamics where the leg has springs."""

_OF_CAMS = {
    **dict.fromkeys(
        ("inverse_dynamics", "forward_dynamics", "mass_matrix", "bias", "gravity_torque", "kinetic_energy", "potential_energy"),
        " Its cam's follower slides as the cam has it, beyond the cam's ends straight on.",
    ),
    **dict.fromkeys(("regressor", "base_parameters"), " The last link is the cam's follower, z along its way, its origin at the roller."),
}
"""What there is to say of dynamics where the leg has a cam."""

IDENTIFIED = {
    "regressor": " Links: one a joint before the linkage, the last with the linkage's frame on it, then those of the linkage in the "
    "spec's order, each about the origin of its own axes, z the plane's normal, then one a joint after the linkage.",
    "base_parameters": "",
}
"""Functions of what every link weighs, plate or not, and what there is to say of a linkage's."""


class LegFunctions:
    """Functions of one leg; its tree of links is made once."""

    def __init__(self, mechanism: Mechanism, leg: Limb) -> None:
        self._mechanism, self._leg, self._tape = mechanism, leg, Tape()

    @cached_property
    def _described(self) -> tuple[Tree, Spread]:
        return spread_leg(self._mechanism, self._leg, symbols_of(joint_port("q", self._leg.joints)), self._tape)

    @cached_property
    def _fewest(self) -> Tree:
        return regrouped(self._described[0], self._tape, floating=False)

    def function(self, name: str) -> Function | None:
        """One of `DYNAMICS` and `SPRUNG`; None where it does not exist: accelerations of a leg that can move without moving mass, fewest
        parameters of one that never assembles, springs of one that has none.
        """
        names = [*(spring.name for spring in self._leg.springs), *(cam.name for cam in self._leg.cams)]
        if name in SPRUNG and not names:
            return None
        entry, joints = (DYNAMICS | SPRUNG)[name], self._leg.joints
        doc = entry.doc
        if names:
            doc = doc.format(springs=", ".join(names)) + _OF_SPRINGS.get(name, "") + (_OF_CAMS.get(name, "") if self._leg.cams else "")
        if self._leg.linkage is not None and name in IDENTIFIED:
            leg, doc = self._whole(), doc + IDENTIFIED[name]
        else:
            tree = self._fewest if entry.by_value else regrouped(self._described[0], self._tape, floating=False, by_value=False)
            leg = LegDynamics(self._mechanism, self._leg, tree, self._described[1], self._tape.fork())
        try:
            built = entry.build(leg)
        except (SingularMatrixError, NoPostureError):
            return None
        inputs, outputs = [leg.ports[port] for port in entry.inputs], entry.outputs(joints, len(built))
        words = signature(self._mechanism, self._leg.name, name, inputs, outputs, doc, entry.source)
        return leg.tape.function(words, built)

    def _whole(self) -> LegDynamics:
        """With all ten parameters of every link."""
        tape = Tape()
        tree, spread = spread_leg(self._mechanism, self._leg, symbols_of(joint_port("q", self._leg.joints)), tape, whole=True)
        return LegDynamics(self._mechanism, self._leg, tree, spread, tape)
