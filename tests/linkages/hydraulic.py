"""The hydraulic leg of the theory's section 6 as a spec: its numbers, masses lumped as there, gravity straight down the plane."""

import math

SPEC = """
walkgen = 1
robot = {{ name = "cylinders", gravity = [0, -9.80665, 0] }}
platforms = [{{ name = "body" }}]
legs = [{{ name = "leg", design = "hydraulic", platform = "body" }}]
[leg_designs.hydraulic]
foot = "shank.P"
assembly = {{ knee = "{knee}", lift = "{lift}" }}
[leg_designs.hydraulic.links]
frame = {{ points = {{ E = [-0.25, 0.10], I = [0.02, -0.01] }} }}
thigh = {{ points = {{ I = [0, 0], H = [0.35, 0], G = [{gx!r}, {gy!r}], J = [{jx!r}, {jy!r}] }}, mass = 5.0, com = [0.16, {c6}] }}
shank = {{ points = {{ P = [0, 0], H = [0.45, 0], L = [{lx!r}, {ly!r}] }}, mass = 4.0, com = [0.25, {c7}] }}
[[leg_designs.hydraulic.pins]]
joins = ["frame.I", "thigh.I"]
[[leg_designs.hydraulic.pins]]
joins = ["thigh.H", "shank.H"]
[[leg_designs.hydraulic.cylinders]]
name = "lift"
between = ["frame.E", "thigh.G"]
driven = true
masses = {{ at_second = 1.2 }}
[[leg_designs.hydraulic.cylinders]]
name = "knee"
between = ["thigh.J", "shank.L"]
driven = true
masses = {{ at_first = 1.8, at_second = 1.0 }}
"""


def spec(alpha=-0.2, beta=1.2, side=1, knee="left", lift="left"):
    """LP = .50, IG = .12, IJ = .10, JH = .30; `side` is s_J."""
    gamma = side * math.acos((0.35**2 + 0.10**2 - 0.30**2) / (2 * 0.35 * 0.10))
    return SPEC.format(
        knee=knee,
        lift=lift,
        gx=0.12 * math.cos(beta),
        gy=0.12 * math.sin(beta),
        jx=0.10 * math.cos(gamma),
        jy=0.10 * math.sin(gamma),
        lx=0.50 * math.cos(alpha),
        ly=0.50 * math.sin(alpha),
        c6=0.02,
        c7=-0.01,
    )
