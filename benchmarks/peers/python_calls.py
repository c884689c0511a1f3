"""Contestants that are called from Python: sympy's lambdify, Pinocchio's bindings, and walkgen's runtime beside them."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pinocchio
import sympy as sp

from peers.formulas import FORMS
from peers.source import Answer, Caller
from peers.sympy_c import SIGNS, P, Q, expressions
from peers.walkgen_c import built
from walkgen.runtime import load


def _lambdified(form: str, module: str) -> Iterable[Caller]:
    """Columns in, a list of columns out; constants stay scalars."""
    for name, ports in expressions(form).items():
        flat = [x for port in ports for x in port]
        given = P if name.startswith("inverse") else Q
        symbols = [*given, *SIGNS] if name == "inverse_branch" else list(given)
        call = sp.lambdify(symbols, flat, modules=module, cse=True)
        signed = _with_signs(call) if name == "inverse_branch" else None
        row = signed or (lambda x, _, call=call: call(*x))
        batch = signed or (lambda x, _, call=call: call(*x.T))
        yield Caller("lambdify", f"{form}, {module}", name, row, batch if module == "numpy" else None)


def _with_signs(call: Answer) -> Answer:
    return lambda x, branch: call(*x.T, 1 - 2 * (branch >> 1), 1 - 2 * (branch & 1))


def _walkgen() -> Iterable[Caller]:
    leg = load(built()).legs["leg"]
    for name in ("foot_position", "foot_position_jacobian", "foot_hessian", "inverse"):
        call = getattr(leg, name)
        yield Caller("walkgen", "runtime", name, lambda x, _, call=call: call(x), lambda x, _, call=call: call(x))
    yield Caller("walkgen", "runtime", "inverse_branch", leg.inverse_branch, leg.inverse_branch)


def _pinocchio() -> Iterable[Caller]:
    """The model of pinocchio.cpp; the bindings have no batches."""
    model = pinocchio.Model()
    quarter = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    thigh, shank = pinocchio.SE3(quarter, np.array([0, 0, 0.12])), pinocchio.SE3(np.eye(3), np.array([0.35, 0, 0]))
    placements = (pinocchio.SE3.Identity(), thigh, shank)
    parent = 0
    for name, placement in zip(("yaw", "thigh", "shank"), placements, strict=True):
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), placement, name)
    end = pinocchio.SE3(np.eye(3), np.array([0.40, 0, 0]))
    foot = model.addFrame(pinocchio.Frame("foot", parent, 0, end, pinocchio.FrameType.OP_FRAME))
    data = model.createData()

    def position(q: Any, _: int) -> Any:
        pinocchio.forwardKinematics(model, data, q)
        return pinocchio.updateFramePlacement(model, data, foot).translation

    def jacobian(q: Any, _: int) -> Any:
        J = pinocchio.computeFrameJacobian(model, data, q, foot, pinocchio.LOCAL_WORLD_ALIGNED)
        return np.concatenate([pinocchio.updateFramePlacement(model, data, foot).translation, J[:3].ravel()])

    yield Caller("Pinocchio", "bindings", "foot_position", position, None)
    yield Caller("Pinocchio", "bindings", "foot_position_jacobian", jacobian, None)


def callers() -> tuple[Caller, ...]:
    """All of them."""
    found = [*_walkgen(), *_pinocchio()]
    for form in FORMS:
        found += [*_lambdified(form, "numpy"), *_lambdified(form, "math")]
    return tuple(found)
