"""The one `contact_forces` that users call: it chooses between the generated solves by method and by what is given."""

from collections.abc import Mapping
from dataclasses import dataclass
from operator import index
from typing import Any, Literal

import numpy as np

from walkgen.runtime.calls import Function
from walkgen.runtime.mistakes import bad_stance, everywhere, lost_loads
from walkgen.signature import STATUSES

Method = Literal["least_squares", "stiffness", "vertical"]
NAME = "contact_forces"
_FEWEST_FACETS, _MOST_FACETS = 3, 1024
_ROUGHEST = 1e8


@dataclass(frozen=True, eq=False, repr=False)
class ContactForces:
    """Forces of the ground on feet in contact that carry a load; `solves` are the robot's generated functions by their names."""

    solves: Mapping[str, Function]

    def __call__(
        self,
        points: Any,
        normals: Any,
        mu: Any = None,
        wrench: Any = None,
        method: Method = "least_squares",
        *,
        cone: Literal["quadratic"] | int = "quadratic",
        torque_rows: Any = None,
        **options: Any,
    ) -> Any:
        """Everything in one frame; leading dimensions are a batch, one value serves all feet.

        Args:
            points: where the feet stand [k,3] (m).
            normals: of the ground, unit, away from it [k,3].
            mu: coefficients of friction [k], below 1e9, infinite too in "stiffness"; not needed by "vertical".
            wrench: load on the robot [6]: force (N), moment about the frame's origin (N m).
            method: "least_squares": least sum weight |f|^2 within the cones; "stiffness": as elastic legs and ground share the load;
                "vertical": three feet without friction.
            cone: "quadratic" for the true cones, or a number of facets of the pyramids inside them; least squares only.
            torque_rows: with torque_limits [r]: sum_i torque_rows[r,i] . f_i <= torque_limits[r] [r,k,3]; least squares only.
            options: weight [k], n_max [k] (N), torque_limits [r]; compliance [k,3,3] or [3k,3k] (m/N), misfit [k,3] (m); param [np].

        Returns:
            f [k,3] (N), status, state [k] (0 sticks, 1 slides, 2 free), certificate [6], violation (N).

        Raises:
            TypeError: an option that the method does not have, or one that it misses.
            ValueError: shapes that do not fit, an unknown method or cone; where every row is BAD_INPUT, what is wrong, and where every
                row is SINGULAR, which loads its feet cannot carry. Other batches tell by their statuses.
        """
        given = {"points": points, "normals": normals, "mu": mu, "wrench": wrench, **options}
        found = self._by_method(method, dict(given), cone, torque_rows)
        if everywhere("BAD_INPUT", found[1]):
            raise ValueError(f"{NAME}: {bad_stance(given | {'torque_rows': torque_rows})}")
        if everywhere("SINGULAR", found[1]):
            raise ValueError(f"{NAME}: {lost_loads(points)}")
        return found

    def _by_method(self, method: Method, given: dict[str, Any], cone: Literal["quadratic"] | int, torque_rows: Any) -> Any:
        if method == "least_squares":
            return self._least_squares(given | {"facets": _facets(cone)}, torque_rows)
        if method not in {"stiffness", "vertical"}:
            raise ValueError(f"{NAME}: {method!r} is not a method; choose least_squares, stiffness or vertical")
        if torque_rows is not None or not _is_round(cone):
            raise TypeError(f"{NAME}: method={method!r} has no {'cone' if torque_rows is None else 'torque_rows'}; least_squares has")
        return self._stiffness(given) if method == "stiffness" else self._vertical(given)

    def _least_squares(self, given: dict[str, Any], torque_rows: Any) -> Any:
        if torque_rows is None:
            return self._solve(NAME, given)
        return self._solve(f"{NAME}_limited", given | {"torque_rows": torque_rows})[:5]

    def _stiffness(self, given: dict[str, Any]) -> Any:
        """Where no forces carry the load, least squares has the proof."""
        compliance, feet = np.asarray(given.pop("compliance", np.nan)), np.shape(given["points"])[-2]
        if compliance.shape[-2:] == (3 * feet, 3 * feet):
            coupled = compliance.reshape(*compliance.shape[:-2], feet, 3, feet, 3)
            f, status, state, _, violation = self._solve(f"{NAME}_coupled", given | {"compliance": coupled})
        elif compliance.shape[-3:] == (feet, 3, 3):
            f, status, state, _, violation = self._solve(f"{NAME}_stiffness", given | {"compliance": compliance})
        else:
            wanted = f"[{feet},3,3] or [{3 * feet},{3 * feet}]"
            raise ValueError(f"{NAME}: compliance has shape {list(compliance.shape)}; stiffness needs {wanted} (m/N)")
        infeasible = np.asarray(status == STATUSES.index("INFEASIBLE"))[..., None]
        if not infeasible.any():
            return f, status, state, np.zeros((*np.shape(status), 6), violation.dtype), violation
        stance = {name: given[name] for name in ("points", "normals", "wrench")} | {"mu": np.minimum(given["mu"], _ROUGHEST)}
        return f, status, state, np.where(infeasible, self._solve(NAME, stance)[3], 0.0), violation

    def _vertical(self, given: dict[str, Any]) -> Any:
        f, status, state, violation = self._solve(f"{NAME}_vertical", {name: given[name] for name in given if name != "mu"})
        return f, status, state, np.zeros((*np.shape(status), 6)), violation

    def _solve(self, name: str, given: dict[str, Any]) -> Any:
        if name not in self.solves:
            raise ValueError(f"{NAME}: this robot was built without {name}; [generate] functions leaves it out")
        return self.solves[name](**given)

    def __repr__(self) -> str:
        methods = ", ".join(sorted(self.solves))
        return f"<function {NAME!r} of any feet: {methods}>"


def _is_round(cone: Literal["quadratic"] | int) -> bool:
    return isinstance(cone, str) and cone == "quadratic"


def _facets(cone: Literal["quadratic"] | int) -> int:
    if _is_round(cone):
        return 0
    try:
        facets = 0 if isinstance(cone, bool | str) else index(cone)
    except TypeError:
        facets = 0
    if not _FEWEST_FACETS <= facets <= _MOST_FACETS:
        wanted = f'give "quadratic" or the number of facets, {_FEWEST_FACETS} to {_MOST_FACETS}'
        raise ValueError(f"{NAME}: cone is {cone!r}; {wanted}")
    return facets
