"""How far every group of a linkage is from where it cannot close, for the generator's own use: it decides whether the linkage assembles."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.signature import Port
from walkgen.symbolic.arrays import compiled
from walkgen.symbolic.closure import closing_at, forward_placing, point_port, unknowns_port
from walkgen.symbolic.frames import parameter_symbols
from walkgen.symbolic.function import Function
from walkgen.symbolic.ports import joint_port, signature
from walkgen.symbolic.starts import FoundStart
from walkgen.symbolic.tape import Tape, symbols_of

Reals = NDArray[np.float64]
Assemble = Callable[[int, Any, Any, Any], tuple[Any, Any]]
"""`walkgen.runtime.solves.assembly.assemble`, which generator stages do not import."""


def assembly_margins(mechanism: Mechanism, leg: Limb) -> Function:
    """q of the drives -> margin of every dyad in the order of placement; the first below 0 is the one that cannot close."""
    tape, drives = Tape(), joint_port("q", leg.joints[len(leg.serial) :])
    placing = forward_placing(leg, symbols_of(drives), parameter_symbols(mechanism), tape)
    port = Port("margins", (len(placing.margins),))
    words = signature(mechanism, leg.name, "assembly_margins", [drives], [port], "", "the discriminant of every dyad")
    return tape.function(words, [margin.value for margin in placing.margins])


def margins_at(mechanism: Mechanism, leg: Limb, start: FoundStart, drives: Reals, assemble: Assemble) -> Reals:
    """The same of a leg with triads for drives [n, drives], parameters at their defaults: [n, groups], NaN from where it cannot close."""
    symbols, count = symbols_of(point_port(mechanism, leg)), unknowns_port(leg).size
    found = closing_at(mechanism, leg, symbols[:-count], symbols[-count:], Tape())
    closure = compiled(found.tape, symbols, [*found.residuals, *(entry for row in found.slopes for entry in row)])
    margins = compiled(found.tape, symbols, [margin.value for margin in found.placing.margins])
    parameters = np.broadcast_to([float(number) for number in start.parameters], (len(drives), len(start.parameters)))
    z = np.concatenate([drives, parameters], -1)
    point = [float(number) for number in (*start.drives, *start.parameters, *start.unknowns)]
    with np.errstate(all="ignore"):
        u, _ = assemble(count, z, point, (lambda points: _rows(closure, points),))
        return _rows(margins, np.concatenate([z, u], -1))


def _rows(function: Callable[..., list[Any]], points: Reals) -> Reals:
    """Values [n, outputs] at points [n, inputs]."""
    return np.stack([np.broadcast_to(np.asarray(value, float), len(points)) for value in function(*points.T)], -1)
