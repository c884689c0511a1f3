"""Lagrange's equations and rates of the leg of specs/mero_leg.toml, simplified by hand: the least that a person leaves to a generator.

Pitch angles are counted from the horizontal, so that the leg is a double pendulum that a yaw carries round; the inertia left after
regrouping is seven numbers.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from peers.formulas import Algebra

Vector = list[Any]
Ports = dict[str, Vector]

NUMBERS = {
    "THIGH": "0.35",
    "SHANK": "0.40",
    "YAW": "0.0035",
    "THIGH_SWUNG": "0.113125",
    "SHANK_SWUNG": "0.0315",
    "COUPLED": "0.042",
    "THIGH_PITCHED": "0.114125",
    "SHANK_PITCHED": "0.032",
    "THIGH_WEIGHT": "3.77556025",
    "SHANK_WEIGHT": "1.176798",
}
"""m, kg m^2 and N m: swung, the axial inertia across a link less that along it, about the yaw; weights, times their levers."""


@dataclass(frozen=True)
class _Leg:
    """Sines and cosines of yaw, thigh and shank (absolute), and what they make."""

    algebra: Algebra
    q: Vector

    def number(self, name: str) -> Any:
        return self.algebra.number(NUMBERS[name])

    @property
    def thigh(self) -> tuple[Any, Any]:
        return self.algebra.cos(self.q[1]), self.algebra.sin(self.q[1])

    @property
    def shank(self) -> tuple[Any, Any]:
        angle = self.q[1] + self.q[2]
        return self.algebra.cos(angle), self.algebra.sin(angle)

    @property
    def coupling(self) -> Any:
        (ct, st), (cs, ss) = self.thigh, self.shank
        return self.number("COUPLED") * (ct * cs + st * ss)

    @property
    def yawed(self) -> Any:
        """Inertia about the yaw."""
        (ct, _), (cs, _) = self.thigh, self.shank
        thigh, shank, both = self.number("THIGH_SWUNG") * ct, self.number("SHANK_SWUNG") * cs, self.number("COUPLED")
        return self.number("YAW") + ct * (thigh + 2 * both * cs) + shank * cs

    def loads(self, qd: Vector, f: Vector) -> Vector:
        """What the efforts hold without acceleration: of yaw, thigh and shank (absolute)."""
        (ct, st), (cs, ss) = self.thigh, self.shank
        both, wide = self.number("COUPLED"), self.number("THIGH_SWUNG") * ct + self.number("COUPLED") * cs
        narrow = self.number("SHANK_SWUNG") * cs + both * ct
        twist, yaw = both * (st * cs - ct * ss), qd[0] * qd[0]
        radial, across = self._felt(f)
        turn = qd[1] + qd[2]
        thigh_arm, shank_arm = self.number("THIGH"), self.number("SHANK")
        about_yaw = -2 * qd[0] * (qd[1] * st * wide + turn * ss * narrow) - (thigh_arm * ct + shank_arm * cs) * across
        about_thigh = twist * turn * turn + yaw * st * wide + self.number("THIGH_WEIGHT") * ct
        about_shank = -twist * qd[1] * qd[1] + yaw * ss * narrow + self.number("SHANK_WEIGHT") * cs
        return [
            about_yaw,
            about_thigh - thigh_arm * (ct * f[2] - st * radial),
            about_shank - shank_arm * (cs * f[2] - ss * radial),
        ]

    def _felt(self, f: Vector) -> tuple[Any, Any]:
        """Foot force away from the yaw axis, and across the leg's plane."""
        cy, sy = self.algebra.cos(self.q[0]), self.algebra.sin(self.q[0])
        return cy * f[0] + sy * f[1], cy * f[1] - sy * f[0]

    @property
    def yaw(self) -> tuple[Any, Any]:
        return self.algebra.cos(self.q[0]), self.algebra.sin(self.q[0])

    @property
    def reach(self) -> Any:
        """The foot's distance from the yaw axis."""
        return self.number("THIGH") * self.thigh[0] + self.number("SHANK") * self.shank[0]

    def centripetal(self, swing: Any, turn: Any) -> tuple[Any, Any]:
        """Acceleration of the foot in the leg's plane, outwards and up, at constant rates of thigh and shank."""
        (ct, st), (cs, ss) = self.thigh, self.shank
        thigh, shank = self.number("THIGH") * (swing * swing), self.number("SHANK") * (turn * turn)
        return -(thigh * ct + shank * cs), -(thigh * st + shank * ss)

    def pitched(self, outwards: Any, up: Any) -> tuple[Any, Any]:
        """Rates of thigh and shank for a velocity in the leg's plane, or accelerations likewise."""
        (ct, st), (cs, ss) = self.thigh, self.shank
        scale = 1 / (ct * ss - st * cs)
        thigh, shank = self.number("THIGH"), self.number("SHANK")
        return scale * (outwards * cs + up * ss) / thigh, -scale * (outwards * ct + up * st) / shank


def _efforts(algebra: Algebra, ports: Ports) -> Vector:
    leg, qdd = _Leg(algebra, ports["q"]), ports["qdd"]
    yaw, thigh, shank = leg.loads(ports["qd"], ports["f"])
    turn = qdd[1] + qdd[2]
    shank = shank + leg.number("SHANK_PITCHED") * turn + leg.coupling * qdd[1]
    thigh = thigh + leg.number("THIGH_PITCHED") * qdd[1] + leg.coupling * turn
    return [yaw + leg.yawed * qdd[0], thigh + shank, shank]


def _mass_matrix(algebra: Algebra, ports: Ports) -> Vector:
    leg = _Leg(algebra, ports["q"])
    shank = leg.number("SHANK_PITCHED")
    mixed = shank + leg.coupling
    return [leg.yawed, 0, 0, 0, leg.number("THIGH_PITCHED") + leg.coupling + mixed, mixed, 0, mixed, shank]


def _accelerations(algebra: Algebra, ports: Ports) -> Vector:
    leg, tau = _Leg(algebra, ports["q"]), ports["tau"]
    yaw, thigh, shank = leg.loads(ports["qd"], ports["f"])
    first, second = tau[1] - tau[2] - thigh, tau[2] - shank
    a, b, k = leg.number("THIGH_PITCHED"), leg.number("SHANK_PITCHED"), leg.coupling
    scale = 1 / (a * b - k * k)
    swing, turn = scale * (b * first - k * second), scale * (a * second - k * first)
    return [(tau[0] - yaw) / leg.yawed, swing, turn - swing]


def _bias(algebra: Algebra, ports: Ports) -> Vector:
    leg, (yaw, thigh, knee) = _Leg(algebra, ports["q"]), ports["qd"]
    (cy, sy), (_, st), (_, ss), turn = leg.yaw, leg.thigh, leg.shank, thigh + knee
    outwards, up = leg.centripetal(thigh, turn)
    outwards = outwards - leg.reach * (yaw * yaw)
    across = -2 * yaw * (leg.number("THIGH") * st * thigh + leg.number("SHANK") * ss * turn)
    return [cy * outwards - sy * across, sy * outwards + cy * across, up, yaw * turn * cy, yaw * turn * sy, 0]


def _rates(algebra: Algebra, ports: Ports) -> Vector:
    leg, v, a = _Leg(algebra, ports["q_bent"]), ports["v"], ports["a"]
    cy, sy = leg.yaw
    outwards, inverse = cy * v[0] + sy * v[1], 1 / leg.reach
    yaw = (cy * v[1] - sy * v[0]) * inverse
    thigh, shank = leg.pitched(outwards, v[2])
    held, up = leg.centripetal(thigh, shank)
    swing, turn = leg.pitched(cy * a[0] + sy * a[1] - held + leg.reach * (yaw * yaw), a[2] - up)
    return [yaw, thigh, shank - thigh, (cy * a[1] - sy * a[0] - 2 * yaw * outwards) * inverse, swing, turn - swing]


CLOSED: dict[str, Callable[[Algebra, Ports], Vector]] = {
    "leg_inverse_dynamics": _efforts,
    "leg_mass_matrix": _mass_matrix,
    "leg_forward_dynamics": _accelerations,
    "leg_bias_acceleration": _bias,
    "leg_inverse_rates": _rates,
}
