"""How far every dyad of a linkage is from where it cannot close, for the generator's own use: it decides whether the linkage assembles."""

from walkgen.model.linkage import Linkage
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.driven import forward_placing
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.tape import Tape, symbols_of


def assembly_margins(mechanism: Mechanism, leg: Limb, linkage: Linkage) -> Function:
    """q of the drives -> margin of every dyad in the order of placement; the first below 0 is the one that cannot close."""
    tape, drives = Tape(), joint_port("q", leg.joints[len(leg.serial) :])
    placing = forward_placing(linkage, symbols_of(drives), parameter_symbols(mechanism), tape)
    port = Port("margins", (len(placing.margins),))
    words = signature(mechanism, leg.name, "assembly_margins", [drives], [port], "", "the discriminant of every dyad")
    return tape.function(words, [margin.value for margin in placing.margins])
