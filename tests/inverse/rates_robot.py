"""One robot with legs of 1 to 7 joints, turning and sliding in many orders, and routes of 6 to 9 joints through chains of platforms."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from oracles.walker import Walker, WalkerLimb, read

LAMBDA = 0.07
HEAD = """walkgen = 1
[robot]
name = "rates"
gravity = [0.0, 0.0, -9.81]
[generate]
functions = ["inverse_velocity", "inverse_acceleration", "inverse_velocity_acceleration"]
[chain_designs.waist]
dh = "classic"
joints = [
  { name = "yaw", type = "revolute", a = 0.10, alpha_deg = 90, d = 0.0 },
  { name = "pitch", type = "revolute", a = 0.02, alpha_deg = 90, d = 0.0, theta_deg = 90 },
  { name = "roll", type = "revolute", a = 0.0, alpha_deg = 20, d = 0.25 },
]
[[platforms]]
name = "front"
[[platforms]]
name = "middle"
parent = "front"
chain = "waist"
root = { xyz = [-0.3, 0.0, 0.1], rpy_deg = [0, 10, 180] }
end = "level"
end_xyz = [-0.3, 0.0, 0.0]
[[platforms]]
name = "rear"
parent = "middle"
chain = "waist"
root = { xyz = [-0.3, 0.1, 0.0], rpy_deg = [0, 0, 180] }
end = { xyz = [0.1, 0.0, 0.2], rpy_deg = [5, 0, 0] }
"""
KINDS = {name: name for name in ("r", "p", "rr", "rp", "pr", "pp", "rrr", "rpr", "rrp", "rpp", "ppp", "rrrr", "rprr", "pppp", "rrrrr")}
KINDS |= {"prrpr": "prrpr", "six": "rrrrrr", "sixmixed": "rrprrp", "seven": "rrrrrrr"}
ROUTED = {"middlethree": ("middle", "rrr"), "middlefour": ("middle", "rprr"), "reartwo": ("rear", "rr"), "rearthree": ("rear", "rpr")}
SQUARE = {"rpp": ("[0, 0, 1]", "[0, 0, -1]", "[1, 0, 0]"), "ppp": ("[0, 0, 1]", "[0, 1, 0]", "[-1, 0, 0]")}
"""Axes of legs whose Jacobian columns are at right angles, so that singular values are equal at every pose."""


@dataclass(frozen=True)
class Path:
    """A leg or route: the owner's name, the oracle's limb from its base to the foot, the damping's epsilon."""

    owner: str
    limb: WalkerLimb
    epsilon: float

    @property
    def n(self) -> int:
        return len(self.limb.joints)

    def motions(self, count, seed):
        """Random q and qd [count, n], and a foot velocity, every second of them the foot's own [count, 3]."""
        generator = np.random.default_rng(seed)
        q = generator.uniform(-np.pi, np.pi, (count, self.n))
        qd, other, v = generator.normal(size=(count, self.n)), generator.normal(size=(count, self.n)), generator.normal(size=(count, 3))
        v[::2] = np.einsum("rij,rj->ri", self.jacobians(q[::2]), other[::2])
        return q, qd, v

    def jacobians(self, q):
        return np.array([self.limb.cross_jacobian(row)[:3] for row in q])

    def biases(self, q, qd):
        return np.array([self.limb.bias_acceleration(*row)[:3] for row in zip(q, qd, strict=True)])


def _design(name: str, kinds: str, epsilon: float | None) -> list[str]:
    generator = np.random.default_rng(sum(map(ord, name)))
    lines = [f"[leg_designs.{name}]", "foot = { xyz = [0.03, 0.0, 0.05] }", *([] if name in SQUARE else ['dh = "classic"'])]
    lines += [f"damping = {{ epsilon = {epsilon}, lambda_max = {LAMBDA} }}"] if epsilon else []
    for index, kind in enumerate(kinds):
        a, d = np.round(generator.uniform(0.1, 0.4, 2), 3)
        alpha, theta = np.round(generator.uniform(-100, 100, 2), 1)
        row = f"a = {a}\nalpha_deg = {alpha}\nd = {d}\ntheta_deg = {theta}"
        lines += [f"[[leg_designs.{name}.joints]]", f'name = "joint{index}"', f'type = "{"revolute" if kind == "r" else "prismatic"}"']
        lines += [f"xyz = [{a}, 0, {d}]\naxis = {SQUARE[name][index]}" if name in SQUARE else row]
    return lines


def _text(epsilons: dict[str, float], names: tuple[str, ...] = (*KINDS, *ROUTED)) -> str:
    lines = []
    for name, (platform, kinds) in ({name: ("front", kinds) for name, kinds in KINDS.items()} | ROUTED).items():
        if name not in names:
            continue
        lines += _design(name, kinds, epsilons.get(name))
        lines += ["[[legs]]", f'name = "{name}"', f'design = "{name}"', f'platform = "{platform}"']
        lines += ["mount = { xyz = [0.1, 0.2, -0.1], rpy_deg = [10, 20, 30] }"]
    return HEAD + "\n".join(lines) + "\n"


def _joined(robot: Walker, leg: WalkerLimb) -> WalkerLimb:
    """Chains and leg as one limb of the root platform."""
    limbs = [leg]
    while limbs[0].platform in robot.chains:
        limbs.insert(0, robot.chains[limbs[0].platform])
    joints, pending = [], np.eye(4)
    for limb in limbs:
        first, *others = limb.joints
        joints += [replace(first, before=pending @ limb.mount @ first.before), *others]
        pending = limb.tip
    return WalkerLimb(leg.name, "front", np.eye(4), tuple(joints), leg.tip, mirrored=False)


@cache
def _epsilons() -> dict[str, float]:
    """For each leg a bound that about three of ten poses are below; a constant Jacobian is just above it, one of two slides below."""
    robot, found = read(_text({})), {}
    for leg in robot.legs:
        limb = _joined(robot, leg)
        q = np.random.default_rng(3).uniform(-np.pi, np.pi, (200, len(limb.joints)))
        least = [np.linalg.svd(limb.cross_jacobian(row)[:3], compute_uv=False)[-1] for row in q]
        found[leg.name] = round(float(np.quantile(least, 0.3)) * (0.9 if leg.name != "pp" else 1.3), 4)
    return found


@cache
def text(robot: str = "all") -> str:
    """The robot with all legs, or the `few`."""
    return _text(_epsilons()) if robot == "all" else _text(_epsilons(), FEW)


@cache
def paths() -> dict[str, Path]:
    """Legs by their names, routes by theirs; a leg and its route are damped alike."""
    robot, epsilons = read(text()), _epsilons()
    legs = [Path(leg.name, leg, epsilons[leg.name]) for leg in robot.legs]
    routes = [Path(f"root_to_{name}", _joined(robot, robot.leg(name)), epsilons[name]) for name in ROUTED]
    return {path.owner: path for path in legs + routes}


FEW = ("r", "p", "rr", "pr", "pp", "rrr", "rpp", "ppp", "rprr", "prrpr", "seven", "middlethree", "reartwo")
FEW += ("root_to_middlethree", "root_to_reartwo")
"""What the ordinary run builds: every number of joints, both kinds, equal singular values, routes through one chain and two."""
OWNERS = (*KINDS, *ROUTED, *(f"root_to_{name}" for name in ROUTED))
