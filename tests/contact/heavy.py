"""The robot of four legs with mass, gravity and a load that are runtime parameters; static stability is its business."""

from quadruped import spec

FUNCTIONS = (
    *("stability_margins", "stability_margins_d_com", "feasible_region", "disturbance_margin"),
    *("tipping_acceleration", "tipping_time", "tipping_tilt", "tipping_speed_limit"),
    *("centroidal_inertia", "com", "demanded_wrench", "centroidal_momentum_matrix"),
)
LINK = "link = { mass = 15, com = [-0.02, 0.01, 0.03], inertia = [0.1, 0.2, 0.25, 0.01, 0, 0] }"
RUNTIME = "{ value = %s, runtime = true }"
HEAVY = (
    spec(*FUNCTIONS, parameters=f"[parameters]\nload = {RUNTIME % 0}\nfall = {RUNTIME % -9.81}")
    .replace("[0, 0, -9.80665]", '[0, 0, "fall"]')
    .replace('{ name = "body" }', '{ name = "body", mass = "load", com = [0, 0, 0.1], inertia = [0, 0, 0, 0, 0, 0] }')
    .replace("d = 0.2 }", f"d = 0.2, {LINK} }}")
)
