"""What leads from the foot of a leg with a linkage to its drives: all poses where they are known, else a search."""

from collections.abc import Iterable

from walkgen.model.classify import CARRIED, CURVE, inverse_class
from walkgen.model.mechanism import Limb, Mechanism
from walkgen.symbolic.carried_inverse import carried_inverse
from walkgen.symbolic.curve_inverse import curve_inverse
from walkgen.symbolic.driven_search import admissible_driven
from walkgen.symbolic.function import Derivation
from walkgen.symbolic.held_inverse import held_inverse
from walkgen.symbolic.linkage_inverse import linkage_inverse


def inverses(mechanism: Mechanism, leg: Limb) -> Iterable[Derivation]:
    """`inverse` first, and what is chosen or measured of its rows; the search alone where there are none."""
    found, linkage = inverse_class(mechanism, leg).name, leg.linkage
    if linkage is None or not found:
        return (admissible_driven(mechanism, leg),)
    if found == CURVE:
        return curve_inverse(mechanism, leg)
    if found == CARRIED:
        return carried_inverse(mechanism, leg)
    return held_inverse(mechanism, leg) if linkage.forward.triads or linkage.inverse.triads else linkage_inverse(mechanism, leg)
