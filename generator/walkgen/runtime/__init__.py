"""Loads what was built and calls it on NumPy arrays; needs numpy alone."""

from walkgen.runtime.absent import MissingFunction
from walkgen.runtime.loading import load
from walkgen.runtime.robot import Chain, Gait, Leg, Robot, Route, Terrain
from walkgen.runtime.work import Work, cycle_work

__all__ = ["Chain", "Gait", "Leg", "MissingFunction", "Robot", "Route", "Terrain", "Work", "cycle_work", "load"]
