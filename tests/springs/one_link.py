"""The chapter's link on a hip with springs to a frame that does not turn (Fig. 13), as a spec of one joint."""

HEAD = """walkgen = 1
[robot]
name = "link"
gravity = [0.0, 0.0, -9.80665]
[generate]
functions = ["spring_length", "spring_tension", "spring_energy", "spring_moment", "unbalance_moment", "potential_energy", "foot_position"]
targets = {targets}
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "link"
platform = "body"
mount = { rpy_deg = [90, 0, 0] }
"""
LINK = """[leg_designs.link]
foot = {{ xyz = [0.40, 0.0, 0.0] }}
[[leg_designs.link.joints]]
name = "hip"
type = "revolute"
xyz = [0.0, 0.0, 0.0]
axis = [0, 0, 1]
link = {{ mass = 4.0, com = [0.18, {aside}, 0.0], inertia = [0.01, 0.06, 0.06, 0.0, 0.0, 0.0] }}
"""
SPRING = """[[leg_designs.link.springs]]
name = "s{number}"
between = [{{ link = "mount", xyz = [{H[0]!r}, {H[1]!r}, 0.0] }}, {{ link = "hip", xyz = [{F[0]!r}, {F[1]!r}, 0.0] }}]
stiffness = {k!r}
free_length = {free!r}
initial_tension = {pull!r}
masses = {{ at_second = {mass!r} }}
"""


def text_of(*springs, aside=0.01, targets=("numpy",)):
    """Of springs with H, F, k, free, pull and mass; the link's centre of mass is at (0.18, aside)."""
    return (
        HEAD.replace("{targets}", str(list(targets)))
        + LINK.format(aside=aside)
        + "".join(SPRING.format(number=number, **spring) for number, spring in enumerate(springs))
    )
