"""One leg told twice: five joints in series, and a yaw joint, a linkage without loops, and two joints after it."""

HEAD = """
walkgen = 1
robot = { name = "bot", gravity = [0.3, 0, -9.81] }
sections = { tube = { E = 70e9, G = 26e9, A = 3e-4, Iy = 2e-8, Iz = 3e-8, J = 4e-8 } }
platforms = [{ name = "body", mass = 9.0, inertia = [0.3, 0.4, 0.5, 0, 0, 0] }]
legs = [
    { name = "leg", design = "leg", platform = "body", mount = { xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] } },
    { name = "other", mirror_of = "leg" },
]
[leg_designs.leg]
dh = "classic"
"""
_YAW = """{ name = "yaw", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 90, limits_deg = [-60, 60], \
link = { mass = 1.0, com = [0, 0.1, 0], inertia = [0.01, 0.02, 0.025, 0, 0, 0], section = "tube" } }"""
_AFTER = """
    { name = "ankle", type = "revolute", a = 0.05, d = 0.02, alpha_deg = 90, limits_deg = [-60, 60], \
link = { mass = 0.5, com = [0.01, 0, 0.02], inertia = [0.01, 0.02, 0.025, 0, 0.001, 0], section = "tube" } },
    { name = "toe", type = "prismatic", a = 0.1, d = 0.05, alpha_deg = 20, limits = [-0.05, 0.1], \
link = { mass = 0.3, com = [0, 0.01, 0], inertia = [0.01, 0.01, 0.01, 0, 0, 0], section = "tube" } },
"""
SIGNS = """
signs = [-1, {}1, -1]
zeros_deg = [5, {}-10, 0]
foot = {{ xyz = [0.02, 0.01, -0.03], rpy_deg = [10, 20, 30] }}
sole = {{ length = 0.1, width = 0.06, rpy_deg = [5, 40, 0] }}
"""
SERIES = (
    HEAD
    + SIGNS.format("1, 1, ", "0, 0, ")
    + f"joints = [{_YAW},"
    + """
    { name = "hip", type = "revolute", a = 0.3, d = 0.0, alpha_deg = 0, limits_deg = [-80, 80], \
link = { mass = 2.0, com = [-0.1, 0.02, 0], inertia = [0.02, 0.02, 0.04, 0, 0, 0], section = "tube" } },
    { name = "knee", type = "revolute", a = 0.4, d = 0.0, alpha_deg = 0, limits_deg = [-120, 120], \
link = { mass = 1.5, com = [-0.2, 0.01, 0], inertia = [0.015, 0.015, 0.03, 0, 0, 0], section = "tube" } },"""
    + _AFTER
    + "]\n"
)
OPEN = (
    HEAD
    + SIGNS.format("", "")
    + f"joints = [{_YAW}]\njoints_after = [{_AFTER}]"
    + """
linkage_end = { point = "shank.P" }
links = { frame = { points = { A = [0, 0] } }, \
thigh = { points = { A = [-0.3, 0], B = [0, 0] }, mass = 2.0, com = [-0.1, 0.02], inertia = 0.04, section = "tube" }, \
shank = { points = { B = [-0.4, 0], P = [0, 0] }, mass = 1.5, com = [-0.2, 0.01], inertia = 0.03, section = "tube" } }
pins = [{ name = "hip", joins = ["frame.A", "thigh.A"], driven = true, limits_deg = [-80, 80] }, \
{ name = "knee", joins = ["thigh.B", "shank.B"], driven = true, limits_deg = [-120, 120] }]
"""
)
