"""Which closed-form inverse a leg admits, and why: read off its joint axes, before any algebra."""

from dataclasses import dataclass

from walkgen.model.mechanism import Limb, Mechanism


@dataclass(frozen=True)
class InverseClass:
    """A leg's class: `name` is empty where no closed form is known; `reason` is a sentence for people."""

    name: str
    branch_names: tuple[str, ...]
    reason: str


NO_CLOSED_FORM = ""
YAW_PITCH_PITCH = "yaw-pitch-pitch"


def inverse_class(mechanism: Mechanism, leg: Limb) -> InverseClass:
    """The class of the leg's position inverse (theory: Pieper 1968; Fig. 7 of the chapter for yaw-pitch-pitch)."""
    raise AssertionError((mechanism, leg))
