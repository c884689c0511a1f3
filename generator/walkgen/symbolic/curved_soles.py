"""All functions of legs with curved soles."""

from collections.abc import Callable

from walkgen.model.mechanism import Limb, Mechanism
from walkgen.symbolic.flat_stance import FlatStance
from walkgen.symbolic.function import Derivation
from walkgen.symbolic.rolling_stance import RollingStance
from walkgen.symbolic.sole_ports import SoleLeg
from walkgen.symbolic.stance_forces import StanceForces


def curved_sole_functions(mechanism: Mechanism, leg: Limb) -> dict[str, Callable[[], Derivation]]:
    """By name; none of another leg."""
    if leg.curved_sole is None:
        return {}
    own = SoleLeg.of(mechanism, leg)
    return {**FlatStance(own).functions(), **RollingStance(own).functions(), **StanceForces(own).functions()}
