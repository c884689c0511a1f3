"""Legs of two six-bars, one behind the other: thigh and shank, each moved by a motor through a Stephenson linkage.

Driven at the crank of its four-bar, a Stephenson is placed by dyads, and a triad leads back from the link that it moves; driven at the
other link on its base, it is a triad, and dyads lead back.
"""

FOUR = {"D": (0.112, -0.042), "G": (0.127, 0.063)}
"""On the base, from A."""
CRANK, COUPLER, ROCKER, ROD, ARM, ON_COUPLER = 0.1, 0.182, 0.149, 0.163, 0.129, (0.106, 0.119)
LIMITS = {"dyads": (15, 85), "triad": (-70, 15)}
"""Of the motors (degrees)."""
HEAD = """
walkgen = 1
robot = {{ name = "bot", gravity = [0, 0, -9.81] }}
platforms = [{{ name = "body", mass = 10, inertia = [0.1, 0.1, 0.1, 0, 0, 0] }}]
legs = [{{ name = "leg", design = "leg", platform = "body", mount = {{ xyz = [0.1, 0.2, 0.3], rpy_deg = [10, 20, 30] }} }}]
[generate]
functions = {functions}
targets = {targets}
[leg_designs.leg]
foot = "shank.P"
plane = {{ rpy_deg = [90, 0, 0] }}
{joints}"""
YAW = 'dh = "classic"\njoints = [{ name = "yaw", type = "revolute", a = 0.05, d = 0.0, alpha_deg = 0, limits_deg = [-40, 50] }]\n'


def leg(thigh, shank, functions, targets=("c", "numpy"), joints=YAW):
    """The spec of a leg; `thigh` and `shank` say how they are placed, by `dyads` or a `triad`."""
    text = HEAD.format(functions=list(functions), targets=list(targets), joints=joints)
    links: dict[str, dict[str, tuple[float, float]]] = {"frame": {}, "thigh": {}, "shank": {"P": (0.3, -0.1)}}
    pins = [*_six_bar(links, 1, "frame", (0.0, 0.0), "thigh", thigh), *_six_bar(links, 2, "thigh", (0.2, -0.05), "shank", shank)]
    return text + "".join(_link(number, *entry) for number, entry in enumerate(links.items())) + "".join(pins)


def _six_bar(links, number, base, at, moved, by):
    """Its links with their points, and its pins."""
    crank, arm = (moved, f"arm_{number}") if by == "triad" else (f"crank_{number}", moved)
    own = {name: f"{name}_{number}" for name in ("coupler", "rocker", "rod")}
    for name, (x, y) in {"A": (0.0, 0.0), **FOUR}.items():
        links[base][f"{name}{number}"] = (round(at[0] + x, 6), round(at[1] + y, 6))
    shapes = {
        crank: {"A": (0.0, 0.0), "B": (CRANK, 0.0)},
        own["coupler"]: {"B": (0.0, 0.0), "C": (COUPLER, 0.0), "E": ON_COUPLER},
        own["rocker"]: {"D": (0.0, 0.0), "C": (ROCKER, 0.0)},
        own["rod"]: {"E": (0.0, 0.0), "F": (ROD, 0.0)},
        arm: {"G": (0.0, 0.0), "F": (ARM, 0.0)},
    }
    for link, points in shapes.items():
        links.setdefault(link, {}).update({f"{name}{number}": point for name, point in points.items()})
    joined = {
        "A": (base, crank),
        "B": (crank, own["coupler"]),
        "C": (own["rocker"], own["coupler"]),
        "D": (base, own["rocker"]),
        "E": (own["coupler"], own["rod"]),
        "F": (own["rod"], arm),
        "G": (base, arm),
    }
    motor = "G" if by == "triad" else "A"
    for name, ends in joined.items():
        joins = ", ".join(f'"{link}.{name}{number}"' for link in ends)
        drive = f'name = "motor_{number}"\ndriven = true\nlimits_deg = {list(LIMITS[by])}\n' if name == motor else ""
        yield f"[[leg_designs.leg.pins]]\njoins = [{joins}]\n{drive}"


def _link(number, name, points):
    places = ", ".join(f"{point} = [{x}, {y}]" for point, (x, y) in points.items())
    mass = f"mass = {0.5 + 0.1 * number:.1f}\ncom = [{0.03 + 0.005 * number:.3f}, 0.01]\ninertia = {0.001 * number:.3f}\n" if number else ""
    return f"[leg_designs.leg.links.{name}]\npoints = {{ {places} }}\n{mass}"
