"""The modular robot adapted to the ground: chain joints chosen for the feet's targets, and the same for velocities (theory 3.3)."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import chain

import sympy

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.model.walk import number
from walkgen.signature import Port, Signature
from walkgen.spec.branches import BRANCHED_JOINTS
from walkgen.symbolic.adapt_driven import DrivenLeg, driven_legs, kind_of
from walkgen.symbolic.adapt_rates import Posture
from walkgen.symbolic.forward import flat
from walkgen.symbolic.frames import Frame, Parameters, parameter_symbols
from walkgen.symbolic.function import Derivation, Solve, Step
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.rate_damping import rate_damping
from walkgen.symbolic.robot import joint_indices
from walkgen.symbolic.rows import parameters_of
from walkgen.symbolic.screws import limits_port, limits_step, screws
from walkgen.symbolic.tape import Tape, Vec

_MOST = {"joints": 96, "feet": 16, "platforms": 16, "chain joints": 32}
_STATUS = Port("status", kind="integer")
_SOURCE = "theory 3.3: Phi(c) with legs in closed form, N = [1; -J_leg^-1 J_chain]"
_NAN = float("nan")


def adapt_functions(mechanism: Mechanism) -> dict[str, Callable[[], Derivation]]:
    """Those that the robot has: it needs connecting chains, and legs of three joints."""
    counts = {
        "joints": sum(len(limb.joints) for limb in mechanism.limbs),
        "feet": len(mechanism.legs),
        "platforms": len(mechanism.platforms),
        "chain joints": sum(len(limb.joints) for limb in mechanism.chains),
    }
    branched = all(len(leg.joints) == BRANCHED_JOINTS for leg in mechanism.legs)
    if not counts["chain joints"] or not branched or any(counts[name] > most for name, most in _MOST.items()):
        return {}
    return {"adapt": lambda: adapt(mechanism), "adapt_velocity": lambda: adapt_velocity(mechanism)}


def adapt(mechanism: Mechanism) -> Solve:
    """Joint values that stand on the targets with the least criterion."""
    joints = [joint for limb in mechanism.limbs for joint in limb.joints]
    feet, platforms = len(mechanism.legs), len(mechanism.platforms)
    weights = tuple(float(number(weight, mechanism)) for weight in mechanism.adapt_weights)
    inputs = [
        Port("targets", (feet, 3), "m"),
        Port("normal", (platforms, 3), default=(0.0,) * (3 * platforms)),
        Port("start", (len(joints),), joint_port("q", joints).unit, default=(_NAN,) * len(joints)),
        Port("weights", (4,), "1, 1, 1/m^2, m", default=weights),
    ]
    outputs = [joint_port("q", joints), _STATUS, Port("cost")]
    doc = (
        "Joint values that put every foot on its target (first platform's frame, fixed) with the least weighted sum of: squared distances "
        "from the middle of the limits, 1 - cos of each platform's tilt from its normal, squared error of its height over its feet. "
        "A zero normal stands for that of the targets' least-squares plane, NaN in start for the middle of the limits."
    )
    words = signature(mechanism, "", "adapt", inputs, outputs, doc, _SOURCE)
    legs, callbacks = driven_legs(mechanism)
    arguments = ("tree", "topology", "limits", "targets", "normal", "start", "weights", len(joints), feet, platforms, legs)
    return replace(_solve(mechanism, words, Step("wg_adapt", (*arguments, "q", "status", "cost"))), callbacks=callbacks)


def adapt_velocity(mechanism: Mechanism) -> Solve:
    """Joint rates that give every foot its velocity, nearest to wanted ones."""
    joints = [joint for limb in mechanism.limbs for joint in limb.joints]
    feet, platforms = len(mechanism.legs), len(mechanism.platforms)
    rates = joint_port("qd0", joints, "/s")
    inputs = [
        joint_port("q", joints),
        Port("xd", (feet, 3), "m/s"),
        Port("qd0", rates.shape, rates.unit, default=(0.0,) * len(joints)),
    ]
    doc = (
        "Joint rates with these foot velocities (first platform's frame, fixed), nearest to qd0 in half ranges of the joints; "
        "SINGULAR while a leg is damped."
    )
    words = signature(mechanism, "", "adapt_velocity", inputs, [joint_port("qd", joints, "/s"), _STATUS], doc, _SOURCE)
    driven = any(leg.linkage for leg in mechanism.legs)
    arguments = ("xd", "qd0", *rate_damping(mechanism, mechanism.legs[0]), len(joints), feet, platforms, "qd", "status")
    step = Step("wg_adapt_velocity", ("tree", "topology", "limits", "still" if driven else "q", *arguments))
    if driven:
        posture = Posture(mechanism, _tree_port(mechanism), _topology_port(mechanism))
        return posture.solve(words, tuple(_topology(mechanism)), step)
    return _solve(mechanism, words, step)


def _solve(mechanism: Mechanism, words: Signature, step: Step) -> Solve:
    joints = [joint for limb in mechanism.limbs for joint in limb.joints]
    tree, topology = _tree_port(mechanism), _topology_port(mechanism)
    tape = Tape()
    data = signature(mechanism, "", "tree", [], [tree, topology], "The robot at q = 0: screws, feet, platforms, who carries whom.", "")
    described = tape.function(data, [*_tree(mechanism, tape), *_topology(mechanism)])
    steps = (Step(described, (*parameters_of(mechanism), "tree", "topology")), limits_step(mechanism, "", joints), step)
    return Solve(words, (tree, topology, limits_port(joints)), steps)


def _tree_port(mechanism: Mechanism) -> Port:
    joints = sum(len(limb.joints) for limb in mechanism.limbs)
    return Port("tree", (6 * joints + 3 * len(mechanism.legs) + 12 * len(mechanism.platforms),), "m and 1")


def _topology_port(mechanism: Mechanism) -> Port:
    joints = sum(len(limb.joints) for limb in mechanism.limbs)
    return Port("topology", (2 * joints + len(mechanism.legs) + len(mechanism.platforms),), kind="integer")


def _tree(mechanism: Mechanism, tape: Tape) -> Iterator[sympy.Expr]:
    """Six numbers a joint, then the feet, then rotation and origin of every platform, in the root platform's frame."""
    parameters = parameter_symbols(mechanism)
    platforms = [_platform(mechanism, index, parameters, tape) for index in range(len(mechanism.platforms))]
    feet = list[Vec]()
    for limb in mechanism.limbs:
        if limb.linkage is not None:
            yield from DrivenLeg(mechanism, limb).numbers()
            feet.append(DrivenLeg(mechanism, limb).foot)
            continue
        own = screws((limb,), parameters, tape, platforms[limb.platform])
        yield from chain.from_iterable(screw.numbers for screw in own.joints)
        feet += [own.tip.origin] if limb.child is None else []
    yield from chain.from_iterable(feet)
    for platform in platforms:
        yield from (*flat(platform.rotation), *platform.origin)


def _platform(mechanism: Mechanism, index: int, parameters: Parameters, tape: Tape) -> Frame:
    return screws(mechanism.ancestors(index), parameters, tape).tip


def _topology(mechanism: Mechanism) -> Iterator[sympy.Integer]:
    """Parents of the joints, kinds, the feet's last joints, the platforms' last joints; -1 is the root platform."""
    carriers = [_last(mechanism, mechanism.ancestors(index)) for index in range(len(mechanism.platforms))]
    for limb in mechanism.limbs:
        places = joint_indices(mechanism, limb)
        yield from (sympy.Integer(carriers[limb.platform] if place == places[0] else place - 1) for place in places)
    for limb in mechanism.limbs:
        yield from (sympy.Integer(kind_of(joint, driven=limb.linkage is not None)) for joint in limb.joints)
    yield from (sympy.Integer(_last(mechanism, (*mechanism.ancestors(leg.platform), leg))) for leg in mechanism.legs)
    yield from map(sympy.Integer, carriers)


def _last(mechanism: Mechanism, limbs: tuple[Limb, ...]) -> int:
    """The last joint of limbs in series; chains without joints carry nothing."""
    places = [place for limb in limbs for place in joint_indices(mechanism, limb)]
    return places[-1] if places else -1
