"""A leg of three joints whose hip has a cam, as a spec; and what follower and spring do, written out: level set by a root of 50 digits."""

import re

import numpy as np

from symbolic.dynamic_legs import EXACT, STEP

G, LOAD, HELD = EXACT.mpf("9.80665"), EXACT.mpf("1.5"), (EXACT.mpf("0.25"), EXACT.mpf("-0.5"))
UP = np.array([0, 0, EXACT.mpf(1)], dtype=object)
SPAN = (-0.6, 0.75)
TEXT = """walkgen = 1
[robot]
name = "cammed"
gravity = [0.0, 0.0, -9.80665]
[leg_designs.arm]
foot = { xyz = [0.35, 0.0, 0.0] }
[[leg_designs.arm.joints]]
name = "yaw"
type = "revolute"
xyz = [0.0, 0.0, 0.0]
axis = [0, 0, 1]
link = { mass = 0.7, com = [0.05, 0.01, 0.02], inertia = [0.01, 0.012, 0.013, 0.001, 0.0, 0.002] }
[[leg_designs.arm.joints]]
name = "hip"
type = "revolute"
xyz = [0.1, 0.0, 0.05]
axis = [0, -1, 0]
link = { mass = 3.0, com = [0.2, 0.01, 0.03], inertia = [0.01, 0.05, 0.05, 0.001, 0.0, 0.002] }
[[leg_designs.arm.joints]]
name = "knee"
type = "revolute"
xyz = [0.4, 0.0, 0.0]
axis = [0, -1, 0]
link = { mass = 1.2, com = [0.15, 0.0, -0.02], inertia = [0.005, 0.02, 0.02, 0.0, 0.001, 0.0] }
[balance.hold]
device = "cam_on_DEVICE"
leg = "leg"
load = 1.5
support = { hip = [-0.6, 0.75] }
held = { yaw = 0.25, knee = -0.5 }
[balance.hold.cam]
roller = 0.012
stiffness = 2000.0
free_length = 0.08
initial_tension = 20.0
LENGTHS
masses = { spring_at_link = 0.15, spring_at_follower = 0.1, follower = 0.9, roller = 0.2 }
[[platforms]]
name = "base"
mass = 3.0
com = [0.1, -0.05, 0.02]
inertia = [0.05, 0.06, 0.07, 0.001, 0.002, -0.003]
[[legs]]
name = "leg"
design = "arm"
platform = "base"
mount = { xyz = [0.1, 0.2, -0.1] }
"""
LENGTHS = {"link": "start = 0.36\narm = 0.12\nreach = 0.10", "frame": "start = 0.2\nanchor = 0.32\nreach = 0.06\ncentre = 0.02"}


def text_of(on):
    """`on` is "link" or "frame"."""
    return TEXT.replace("DEVICE", on).replace("LENGTHS", LENGTHS[on])


def bare_of(text):
    return re.sub(r"\[balance\.hold\].*?(?=\[\[platforms)", "", text, flags=re.DOTALL)


NUMBERS = {
    "link": {"start": "0.36", "lever": "0.12", "reach": "0.10"},
    "frame": {"start": "0.2", "lever": "0.32", "reach": "0.06"},
}


class Cammed:
    """What the hip's cam moves; `links` gives the potential of the bare leg at q."""

    def __init__(self, on, links):
        self.on, self._links = on, links
        self._start, self._lever, self._reach = (EXACT.mpf(NUMBERS[on][key]) for key in ("start", "lever", "reach"))
        self._level = self._total(EXACT.mpf(str(SPAN[0])), self._start)

    def _total(self, phi, r):
        """With the load, which the foot carries, the other joints held."""
        q = np.array([HELD[0], phi, HELD[1]], dtype=object)
        foot = EXACT.mpf("0.4") * EXACT.sin(phi) + EXACT.mpf("0.35") * EXACT.sin(phi + q[2])
        return self._links(q) + self.hanging(q, r) + self.stored(q, r) - LOAD * G * foot

    def way(self, q):
        """Of the roller."""
        return EXACT.findroot(lambda r: self._total(q[1], r) - self._level, (self._start, self._start + EXACT.mpf("0.01")), tol=1e-90)

    def _places(self, q):
        """The hip, and the link's direction."""
        ahead = np.array([EXACT.cos(q[0]), EXACT.sin(q[0]), 0], dtype=object)
        hip = np.array([EXACT.mpf(entry) for entry in ("0.1", "0.2", "-0.05")], dtype=object) + EXACT.mpf("0.1") * ahead
        return hip, EXACT.cos(q[1]) * ahead + EXACT.sin(q[1]) * UP

    def points(self, q, r):
        """Masses and where they are: the spring's end at the follower, follower, roller, the spring's end on the link."""
        hip, link = self._places(q)
        end, follower, roller, at_link = (EXACT.mpf(mass) for mass in ("0.1", "0.9", "0.2", "0.15"))
        if self.on == "link":
            return [(end, hip + (r - self._reach) * UP), (follower + roller, hip + r * UP), (at_link, hip + self._lever * link)]
        return [(end, hip + (r + self._reach) * link), (follower, hip + (r + EXACT.mpf("0.02")) * link), (roller, hip + r * link)]

    def hanging(self, q, r):
        return G * sum(mass * at[2] for mass, at in self.points(q, r))

    def length(self, q, r):
        """Of the spring, to the link or to the frame."""
        hip, link = self._places(q)
        other = hip + self._lever * (link if self.on == "link" else UP)
        return EXACT.sqrt(sum((self.points(q, r)[0][1] - other) ** 2))

    def stored(self, q, r):
        """In the spring since its free length."""
        more = self.length(q, r) - EXACT.mpf("0.08")
        return more * (20 + 1000 * more)

    def moving(self, q, qd):
        """Kinetic energy of the masses, by differences."""
        ahead, behind = (self.points(at, self.way(at)) for at in (q + STEP * qd, q - STEP * qd))
        speeds = [(mass, (one - other) / (2 * STEP)) for (mass, one), (_, other) in zip(ahead, behind, strict=True)]
        return sum(mass * (speed**2).sum() for mass, speed in speeds) / 2
