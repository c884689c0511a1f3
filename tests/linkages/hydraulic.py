"""The hydraulic leg of the theory's section 6 as a spec: its numbers, masses lumped as there, gravity straight down the plane."""

import math

FUNCTIONS = (
    "foot_position",
    "foot_velocity",
    "foot_acceleration",
    "foot_spatial_jacobian",
    "foot_bias_acceleration",
    "joint_frames",
    "inverse",
    "inverse_velocity",
    "inverse_acceleration",
    "inverse_velocity_acceleration",
    "gravity_torque",
    "assembly_status",
    "transmission_angles",
    "driving_forces",
    "power",
    "joint_reactions",
)
SPEC = """
walkgen = 1
robot = {{ name = "cylinders", gravity = [0, -9.80665, 0] }}
platforms = [{{ name = "body" }}]
legs = [{{ name = "leg", design = "hydraulic", platform = "body" }}]
{generate}
[leg_designs.hydraulic]
foot = "shank.P"
assembly = {{ knee = "{knee}", lift = "{lift}" }}
[leg_designs.hydraulic.links]
frame = {{ points = {{ E = [-0.25, 0.10], I = [0.02, -0.01] }} }}
thigh = {{ points = {{ I = [0, 0], H = [0.35, 0], G = {G}, J = {J} }}, mass = 5.0, com = [0.16, {c6}] }}
shank = {{ points = {{ P = [0, 0], H = [0.45, 0], L = {L} }}, mass = 4.0, com = [0.25, {c7}] }}
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


def plates(alpha=-0.2, beta=1.2, side=1):
    """Points G and J of the thigh, L of the shank: LP = .50, IG = .12, IJ = .10, JH = .30; `side` is s_J."""
    gamma = side * math.acos((0.35**2 + 0.10**2 - 0.30**2) / (2 * 0.35 * 0.10))
    polar = {"G": (0.12, beta), "J": (0.10, gamma), "L": (0.50, alpha)}
    return {name: [radius * math.cos(angle), radius * math.sin(angle)] for name, (radius, angle) in polar.items()}


def spec(alpha=-0.2, beta=1.2, side=1, knee="left", lift="left", functions=None):
    """The leg, all functions or those named, in NumPy alone."""
    generate = f'generate = {{ functions = [{", ".join(f"{name!r}" for name in functions)}], targets = ["numpy"] }}' if functions else ""
    points = plates(alpha, beta, side)
    return SPEC.format(knee=knee, lift=lift, c6=0.02, c7=-0.01, generate=generate, **points)
