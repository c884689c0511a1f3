"""Legs whose joints are planned, and not their feet alone: those with a path of their own, those that roll on curved soles."""

from walkgen.gait.driven import is_driven
from walkgen.gait.rolling import is_rolling
from walkgen.runtime.robot import Leg


def is_planned(leg: Leg) -> bool:
    """Whether the leg's joints are planned."""
    return is_driven(leg) or is_rolling(leg)
