"""What two routes share that differ in the side on which their legs stand is what each would get from its own path."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from walkgen.graph.interpret import interpret
from walkgen.graph.lower import lower
from walkgen.graph.program import Composite, Program
from walkgen.graph.sharing import nameless
from walkgen.model.transform import X, rotation
from walkgen.pipeline import mechanism_of
from walkgen.runtime.solves.columns import second_derivatives
from walkgen.spec.scalar import exact
from walkgen.symbolic import columns
from walkgen.symbolic import derive as derivation
from walkgen.symbolic.derive import derive, routes
from walkgen.symbolic.forward import FOOT
from walkgen.symbolic.sides import sides

MERO = Path(__file__).parents[2] / "specs" / "mero.toml"
PAIRS = [("root_to_middle_left", "root_to_middle_right"), ("root_to_rear_left", "root_to_rear_right")]
RATES = ("inverse_velocity", "inverse_acceleration", "inverse_velocity_acceleration")


def of_routes(mechanism, names):
    return {d.signature.full_name: lower(d) for d in derive(mechanism, names) if d.signature.owner.startswith("root_to_")}


def computed(body, values):
    """All values by name: of a Program its outputs, of a Composite what each step gives, routines by their references."""
    if isinstance(body, Program):
        found = interpret(body, {port.name: np.ravel(values[port.name]).tolist() for port in body.signature.inputs})
        return {port.name: np.reshape(found[port.name], port.shape) for port in body.signature.outputs}
    for call in body.calls:
        given = [
            values[each] if isinstance(each, str) else float(each) for each in call.arguments if not isinstance(each, str) or each in values
        ]
        names = [each for each in call.arguments if isinstance(each, str) and each not in values]
        if isinstance(call.callee, Program):
            inputs = {port.name: value for port, value in zip(call.callee.signature.inputs, given, strict=True)}
            values = values | dict(zip(names, computed(call.callee, inputs).values(), strict=True))
        else:
            assert call.callee == "wg_second_derivatives"
            J, axes, n = given
            values = values | {names[0]: second_derivatives(J, axes, int(n))}
    return values


def test_all_of_a_path_is_the_same_for_the_other_side(monkeypatch):
    mechanism = mechanism_of(MERO)
    shared = of_routes(mechanism, tuple(FOOT))
    monkeypatch.setattr(derivation, "sides", lambda *_: {})
    monkeypatch.setattr(columns, "_MANY", 99)
    alone = of_routes(mechanism, tuple(FOOT))
    assert shared.keys() == alone.keys()
    assert all(isinstance(body, Composite) for body in shared.values())
    assert all(isinstance(body, Program) for body in alone.values())

    rng = np.random.default_rng(5)
    for name, body in shared.items():
        inputs = {port.name: rng.uniform(-1.5, 1.5, port.size) for port in body.signature.inputs}
        found, wanted = computed(body, inputs), computed(alone[name], inputs)
        for port in body.signature.outputs:
            np.testing.assert_allclose(found[port.name], wanted[port.name], rtol=0, atol=1e-13)


@pytest.mark.parametrize(("one", "other"), PAIRS)
def test_both_sides_have_one_text(one, other):
    code = of_routes(mechanism_of(MERO), (*FOOT, *RATES))
    for name in (*FOOT, *RATES):
        calls = [code[f"mero_{owner}_{name}"].calls for owner in (one, other)]
        texts = [[call.callee if isinstance(call.callee, str) else nameless(call.callee) for call in each] for each in calls]
        assert texts[0] == texts[1]
        assert calls[0][0].arguments != calls[1][0].arguments


def test_what_differs_otherwise_is_not_shared():
    mechanism = mechanism_of(MERO)
    *legs, last = mechanism.legs
    assert len(sides(mechanism, routes(mechanism))) == 4
    raised = replace(last, mount=(*last.mount, *rotation(X, exact("0.1"))))
    assert len(sides(mechanism, routes(replace(mechanism, legs=(*legs, raised))))) == 2
    longer = replace(last, joints=(*last.joints[:-1], replace(last.joints[-1], sign=-last.joints[-1].sign)))
    assert len(sides(mechanism, routes(replace(mechanism, legs=(*legs, longer))))) == 2
