"""Section 6 of the theory in 40 digits: the hydraulic leg by its own formulas, vectors as complex numbers."""

from dataclasses import dataclass
from functools import cached_property

import mpmath

from linkages.hydraulic import plates

MP = mpmath.mp.clone()
MP.dps = 40
G = MP.mpf("9.80665")
E, I = MP.mpc("-0.25", "0.10"), MP.mpc("0.02", "-0.01")  # noqa: E741 - the chapter's name
HI, HP = MP.mpf("0.35"), MP.mpf("0.45")
C6, C7 = MP.mpc("0.16", "0.02"), MP.mpc("0.25", "-0.01")
M5, M6, M7, M8, M9 = MP.mpf("1.2"), MP.mpf(5), MP.mpf(4), MP.mpf(1), MP.mpf("1.8")


def cross(a, b):
    return (MP.conj(a) * b).imag


def dot(a, b):
    return (MP.conj(a) * b).real


def unit(a):
    return a / abs(a)


def down(mass):
    """(0, m g): what carries a mass."""
    return MP.mpc(0, mass * G)


def circles(p, r_p, q, r_q, side):
    """The point at distance r_p of p and r_q of q, on the left of p -> q for side 1."""
    span = abs(q - p)
    along = (span**2 + r_p**2 - r_q**2) / (2 * span)
    return p + unit(q - p) * MP.mpc(along, side * MP.sqrt(r_p**2 - along**2))


@dataclass(frozen=True)
class Pose:
    """Directions e(f) of I -> H and e(q) of P -> H, on plates with the points g, j, l in their own axes."""

    thigh: mpmath.mpc
    shank: mpmath.mpc
    g: mpmath.mpc
    j: mpmath.mpc
    l: mpmath.mpc  # noqa: E741 - the chapter's name

    def __getattr__(self, name):
        """H, G, J, G6 of the thigh, P, L, G7 of the shank."""
        own = {"H": HI, "G": self.g, "J": self.j, "G6": C6}
        if name in own:
            return I + self.thigh * own[name]
        return self.H + self.shank * ({"P": 0, "L": self.l, "G7": C7}[name] - HP)

    @property
    def f(self):
        return MP.arg(self.thigh)

    @property
    def q(self):
        return MP.arg(self.shank)

    @property
    def lengths(self):
        """EG (lift) and JL (knee): the order of walkgen's q."""
        return abs(self.G - E), abs(self.L - self.J)

    @property
    def u1(self):
        return unit(self.G - E)

    @property
    def u2(self):
        return unit(self.L - self.J)

    @property
    def psi(self):
        return MP.arg((I - self.G) / (E - self.G))

    @property
    def theta(self):
        return MP.arg((self.H - self.L) / (self.J - self.L))

    def turns(self, v):
        """fd, qd for the rate v of P."""
        size = HI * HP * cross(self.thigh, self.shank)
        return HP / size * dot(v, self.shank), HI / size * dot(v, self.thigh)

    def second_turns(self, v, a):
        """fdd, qdd."""
        fd, qd = self.turns(v)
        return self.turns(a + HI * fd**2 * self.thigh - HP * qd**2 * self.shank)

    def length_rates(self, v):
        """Of EG and JL."""
        fd, qd = self.turns(v)
        return dot(self.u1, self._at(self.g, fd)), dot(self.u2, self._on_shank(v, qd) - self._at(self.j, fd))

    def second_length_rates(self, v, a):
        """By the second derivative of a distance, (r.rdd + rd.rd - ld^2) / l."""
        (fd, qd), (fdd, qdd) = self.turns(v), self.second_turns(v, a)
        g, j = (self.thigh * point for point in (self.g, self.j))
        bent = lambda r, rate, second: MP.mpc(-(rate**2), second) * r  # noqa: E731 - a formula
        lift = (self.G - E, self._at(self.g, fd), bent(g, fd, fdd))
        foot = self.shank * self.l
        knee = (self.L - self.J, self._on_shank(v, qd) - self._at(self.j, fd), a + bent(foot, qd, qdd) - bent(j, fd, fdd))
        return [(dot(r, rdd) + abs(rd) ** 2 - (dot(r, rd) / abs(r)) ** 2) / abs(r) for r, rd, rdd in (lift, knee)]

    def potential_rate(self, v):
        """Of the weights, by the rates of their heights."""
        fd, qd = self.turns(v)
        on_thigh = M6 * C6 + M5 * self.g + M9 * self.j
        on_shank = [(M7, MP.mpc(0, qd) * self.shank * C7), (M8, MP.mpc(0, qd) * self.shank * self.l)]
        return G * (self._at(on_thigh, fd).imag + sum(mass * (v + turn).imag for mass, turn in on_shank))

    def _at(self, point, rate):
        return MP.mpc(0, rate) * self.thigh * point

    def _on_shank(self, v, rate):
        return v + MP.mpc(0, rate) * self.shank * self.l

    def forces(self, load):
        """Quasi-static, theory 6.4; `load` is the ground's force on P."""
        return Forces(self, load)


@dataclass(frozen=True)
class Forces:
    pose: Pose
    load: mpmath.mpc

    @cached_property
    def d1(self):
        return cross(self.pose.H - self.pose.L, self.pose.u2)

    @cached_property
    def d2(self):
        return cross(I - self.pose.G, self.pose.u1)

    @cached_property
    def fd1(self):
        p, q = self.pose, self.load
        torque = q.real * (p.H - p.P).imag - q.imag * (p.H - p.P).real
        return (torque + M8 * G * (p.H - p.L).real + M7 * G * (p.H - p.G7).real) / self.d1

    @cached_property
    def r69(self):
        return self.fd1 * self.pose.u2 + down(M9)

    @cached_property
    def r67(self):
        return -self.load - self.fd1 * self.pose.u2 + down(M7 + M8)

    @cached_property
    def fd2(self):
        p = self.pose
        weights = M5 * G * (I - p.G).real + M6 * G * (I - p.G6).real
        return (weights + cross(I - p.J, self.r69) + cross(I - p.H, self.r67)) / self.d2

    @cached_property
    def r06(self):
        return -self.fd2 * self.pose.u1 + self.r69 + self.r67 + down(M5 + M6)


def plate_points(**plate):
    """The spec's own doubles."""
    return {name.lower(): MP.mpc(*point) for name, point in plates(**plate).items()}


def reaching(foot, knee=1, **plate):
    """By P: theory 6.2; knee +1 has H on the left of the ray I -> P."""
    h = circles(I, HI, foot, HP, knee)
    return Pose((h - I) / HI, (h - foot) / HP, **plate_points(**plate))


def driven(lengths, sides=(1, 1), **plate):
    """By the lengths of EG and JL, each dyad on a side: left of E -> I, left of J -> H."""
    points = plate_points(**plate)
    thigh = (circles(E, MP.mpf(lengths[0]), I, abs(points["g"]), sides[0]) - I) / points["g"]
    h, j = I + HI * thigh, I + thigh * points["j"]
    arm = points["l"] - HP
    shank = (circles(j, MP.mpf(lengths[1]), h, abs(arm), sides[1]) - h) / arm
    return Pose(thigh, shank, **points)
