"""Specs of a robot of six legs with the gaits that a test writes."""

NAMES = ("lf", "rf", "lm", "rm", "lr", "rr")
"""The feet in order."""
SIDES = 'left = ["lf", "lm", "lr"]\nright = ["rf", "rm", "rr"]\n'
STANCE = "stance = {{ {} }}\n".format(
    ", ".join(
        f"{name} = [{x}, {y}, -0.3]" for name, (x, y) in zip(NAMES, ((x, y) for x in (0.3, 0.0, -0.35) for y in (0.3, -0.25)), strict=True)
    )
)
_LEG = """
[[legs]]
name = "{name}"
design = "l"
platform = "body"
mount = {{ xyz = [{x}, {y}, 0] }}
"""


def spec(gaits: str, parameters: str = "", names: tuple[str, ...] = NAMES, functions: str = "") -> str:
    """The robot with these [gait...] tables."""
    wanted = functions or '["foot_position", "states", "leg_phase", "next_event", "foot_transfers", "foot_targets"]'
    head = f"""walkgen = 1
[robot]
name = "six"
gravity = [0, 0, -9.8]
[generate]
functions = {wanted}
[parameters]
{parameters}
[leg_designs.l]
dh = "classic"
joints = [{{ name = "a", type = "revolute", a = 0.1, alpha_deg = 90, d = 0.0 }}]
[[platforms]]
name = "body"
"""
    legs = (_LEG.format(name=name, x=0.3 - 0.3 * (place // 2), y=0.2 - 0.4 * (place % 2)) for place, name in enumerate(names))
    return head + "".join(legs) + gaits
