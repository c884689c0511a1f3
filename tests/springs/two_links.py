"""The chapter's leg with two active pairs at one hip (Fig. 14): links 3 (B C), 5 (B E), 4 (C D P) and 6 (E D), any lengths."""

import numpy as np

HEAD = """walkgen = 1
[robot]
name = "fig14"
gravity = [0.0, -9.80665, 0.0]
[generate]
functions = ["unbalance_moment", "joint_reactions", "potential_energy", "foot_position", "spring_moment"]
targets = {targets}
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "legs"
platform = "body"
[leg_designs.legs]
foot = "link4.P"
assembly = {{ d = "{side}" }}
[leg_designs.legs.links.frame]
mass = {m2!r}
com = [0.1, 0.2]
inertia = 0.1
points = {{ B = [0.0, 0.0]{anchors} }}
[leg_designs.legs.links.link3]
points = {{ B = [0.0, 0.0], C = {C}{on3} }}
[leg_designs.legs.links.link5]
points = {{ B = [0.0, 0.0], E = {E}{on5} }}
[leg_designs.legs.links.link4]
points = {{ C = [0.0, 0.0], D = {CD}, P = {CP} }}
mass = 3.0
com = {CG}
inertia = 0.1
[leg_designs.legs.links.link6]
points = {{ E = [0.0, 0.0], D = {ED} }}
mass = 1.5
com = {EG}
inertia = 0.1
[[leg_designs.legs.pins]]
name = "front"
joins = ["frame.B", "link3.B"]
driven = true
[[leg_designs.legs.pins]]
name = "rear"
joins = ["frame.B", "link5.B"]
driven = true
[[leg_designs.legs.pins]]
joins = ["link3.C", "link4.C"]
[[leg_designs.legs.pins]]
joins = ["link5.E", "link6.E"]
[[leg_designs.legs.pins]]
joins = ["link4.D", "link6.D"]
"""
SPRING = """[[leg_designs.legs.springs]]
name = "{name}"
between = ["frame.H{name}", "link{link}.F{name}"]
stiffness = {k!r}
free_length = {free!r}
initial_tension = {pull!r}
"""
SLACK = {"name": "s", "link": 3, "H": (0.0, -0.2), "F": (0.1, 0.0), "k": 1e-12, "free": 0.0, "pull": 0.0}
"""A spring that does not pull, so that the leg has the functions of springs."""


def _entries(z):
    return f"[{float(np.real(z))!r}, {float(np.imag(z))!r}]"


def text_of(C, E, D, P, G4, G6, springs=(SLACK,), m2=0.0, targets=("numpy",)):
    """A leg that has these points (complex) at link 3's and 5's angles; links 4 and 6 have axes along the frame's there.

    Springs have a name, a link (3 or 5), H on the frame, F in the link's axes, k, free and pull.
    """

    def hooks(key, links):
        return "".join(
            f", {key}{spring['name']} = [{spring[key][0]!r}, {spring[key][1]!r}]" for spring in springs if spring["link"] in links
        )

    side = "left" if ((E - C).conjugate() * (D - C)).imag > 0 else "right"
    head = HEAD.format(
        side=side,
        m2=m2,
        targets=list(targets),
        anchors=hooks("H", (3, 5)),
        on3=hooks("F", (3,)),
        on5=hooks("F", (5,)),
        C=_entries(abs(C)),
        E=_entries(abs(E)),
        CD=_entries(D - C),
        CP=_entries(P - C),
        CG=_entries(G4 - C),
        ED=_entries(D - E),
        EG=_entries(G6 - E),
    )
    return head + "".join(SPRING.format(**spring) for spring in springs)


def pantograph(phi3=-0.3, phi5=-1.9, **more):
    """The theory's parallelogram: BC = ED = 0.4, BE = CD = 0.2, CP = 0.5."""
    C, E = 0.4 * np.exp(1j * phi3), 0.2 * np.exp(1j * phi5)
    D, P = C + E, C + 2.5 * E
    return text_of(C, E, D, P, C + 0.4 * (P - C), (E + D) / 2, **more)
