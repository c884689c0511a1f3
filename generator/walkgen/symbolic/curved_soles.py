"""All functions of legs with curved soles."""

from collections.abc import Callable

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.driven import kinematics_of
from walkgen.symbolic.flat_stance import FlatStance
from walkgen.symbolic.frames import expression, parameter_symbols
from walkgen.symbolic.function import Derivation, Function
from walkgen.symbolic.ports import joint_port
from walkgen.symbolic.rolling_stance import RollingStance
from walkgen.symbolic.sole_ports import SoleLeg
from walkgen.symbolic.stance_forces import StanceForces
from walkgen.symbolic.tape import Tape, minus, plus, scaled, symbols_of


def curved_sole_functions(mechanism: Mechanism, leg: Limb) -> dict[str, Callable[[], Derivation]]:
    """By name; none of another leg."""
    if leg.curved_sole is None:
        return {}
    own = SoleLeg.of(mechanism, leg)
    line = {} if leg.curved_sole.width is None else {"contact_line": lambda: contact_line(own)}
    return {**FlatStance(own).functions(), **RollingStance(own).functions(), **line, **StanceForces(own).functions()}


def contact_line(own: SoleLeg) -> Function:
    """[2,3]."""
    assert own.leg.sole.width is not None
    tape, parameters, q = Tape(), parameter_symbols(own.mechanism), joint_port("q", own.limb.joints)
    kinematics = kinematics_of((own.limb,), symbols_of(q), parameters, tape)
    half = tape.vector("half", scaled(expression(own.leg.sole.width, parameters) / 2, kinematics.rotation[2]))
    found = [*plus(kinematics.position, half), *minus(kinematics.position, half)]
    doc = (
        "Ends of the generatrix on which the sole touches level ground, in the platform's frame, that of the foot frame's z first: "
        "where the sole lies flat, of the line below the ankle."
    )
    return own.function(tape, "contact_line", [q], [Port("p", (2, 3), "m")], found, doc, "theory 8.3")
