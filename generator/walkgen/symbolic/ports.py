"""The ports of the generated functions: what a name means, its shape and unit, said once."""

from collections.abc import Sequence

from walkgen.model.mechanism import Joint, Mechanism
from walkgen.signature import Port, Signature

DRIVE = Port("drive", (1,), "rad or m")
"""Of a linkage whose foot follows a curve."""


def joint_unit(joints: Sequence[Joint]) -> str:
    """rad, m, or both where the joints differ."""
    kinds = {joint.kind for joint in joints}
    return "rad" if kinds == {"revolute"} else "m" if kinds == {"prismatic"} else "rad or m"


def joint_port(name: str, joints: Sequence[Joint], per: str = "") -> Port:
    """An array over joints: q, qd (per = "/s") or qdd ("/s^2")."""
    return Port(name, (len(joints),), joint_unit(joints) + per)


def parameter_ports(mechanism: Mechanism) -> tuple[Port, ...]:
    """`param`, last input of every function, where the robot has runtime parameters."""
    return (Port("param", (len(mechanism.parameters),), "as declared"),) if mechanism.parameters else ()


def signature(
    mechanism: Mechanism, owner: str, name: str, inputs: Sequence[Port], outputs: Sequence[Port], doc: str, source: str
) -> Signature:
    """A function of this robot; `param` is appended to its inputs."""
    return Signature(mechanism.name, owner, name, (*inputs, *parameter_ports(mechanism)), tuple(outputs), doc, source)
