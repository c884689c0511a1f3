"""How far every dyad of a linkage is from where it cannot close, and where its bodies are, for the generator's own use."""

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.driven import forward_placing
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.tape import Tape, symbols_of


def assembled_poses(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Function:
    """q of the drives -> margin of every dyad as they are placed, of which the first below 0 cannot close; x, y, cosine, sine of bodies."""
    tape, drives = Tape(), joint_port("q", leg.joints[len(leg.serial) :])
    placing = forward_placing(linkage, symbols_of(drives), parameter_symbols(mechanism), tape)
    bodies = [placing.pose(body) for body in range(len(linkage.structure.names))]
    ports = [Port("margins", (len(placing.margins),)), Port("poses", (len(bodies), 4))]
    words = signature(mechanism, leg.name, "assembled_poses", [drives], ports, "", "the discriminant of every dyad")
    values = [margin.value for margin in placing.margins]
    return tape.function(words, [*values, *(entry for pose in bodies for entry in (*pose.origin, *pose.rotor))])
