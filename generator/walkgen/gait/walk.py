"""A simulated walk: everything about it at every instant, and what stands against it."""

from dataclasses import dataclass

import numpy as np

from walkgen.gait.faults import Fault
from walkgen.gait.footholds import Holds
from walkgen.gait.power import Power
from walkgen.gait.stance_margins import Margins
from walkgen.gait.standing import Standing
from walkgen.gait.steps import Steps
from walkgen.gait.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Walk:
    """Of a robot with k legs and nq joints at instants [t]; the world's z is up, everything is in SI units.

    Attributes:
        robot: its name.
        legs: names, in the order of the feet.
        joints: names, in the order of q.
        trajectory: the gait and stance, as they were walked.
        times: instants [t] (s).
        base_pose: world_T_platform of the first platform [t,4,4].
        q: joint values [t,nq]; qd and qdd their rates and accelerations.
        qd: [t,nq].
        qdd: [t,nq].
        stance: whether each leg supports [t,k].
        standing: the feet, or the corners of their soles, and which support.
        feet: in the world [t,k,3] (m), by the forward kinematics of q.
        targets: where they are meant to be [t,k,3] (m).
        statuses: of every leg's inverse [t,k].
        com: centre of mass in the world [t,3] (m); NaN of a robot without mass.
        margins: of stability, negative where the robot falls.
        static: whether the static margin is the one that has to hold; else the dynamic one.
        holds: footholds, one a support.
        power: of all joints; None where the robot was built without the functions that it takes.
        faults: why the walk is not feasible.
    """

    robot: str
    legs: tuple[str, ...]
    joints: tuple[str, ...]
    trajectory: Trajectory | Steps
    times: np.ndarray
    base_pose: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    stance: np.ndarray
    standing: Standing
    feet: np.ndarray
    targets: np.ndarray
    statuses: np.ndarray
    com: np.ndarray
    margins: Margins
    static: bool
    holds: Holds
    power: Power | None
    faults: tuple[Fault, ...]

    @property
    def feasible(self) -> bool:
        """Every foot reaches its footholds within limits and speeds, and the margin holds."""
        return not self.faults

    @property
    def least_margin(self) -> float:
        """Static, over the walk (m)."""
        return float(self.margins.static.min())

    @property
    def least_dynamic_margin(self) -> float:
        """With inertia, over the walk (m); NaN where the robot was built without `demanded_wrench`."""
        return float(self.margins.dynamic.min())

    @property
    def margin_summary(self) -> str:
        """The least margin of the kind that has to hold, in words."""
        kind, least = ("static", self.least_margin) if self.static else ("dynamic", self.least_dynamic_margin)
        return f"least {kind} margin {least:.4g} m"

    @property
    def slip(self) -> float:
        """How far a supporting foot is from its foothold at most (m)."""
        away = np.linalg.norm(self.feet - self.targets, axis=-1)
        return float(np.max(away[self.stance], initial=0.0))

    @property
    def energy(self) -> dict[str, float]:
        """Work of all joints over the walk (J): weight, inertia, friction, total, and `positive`: what drives give that recover nothing."""
        if self.power is None:
            return {}
        parts = {"weight": self.power.weight, "inertia": self.power.inertia, "friction": self.power.friction, "total": self.power.total}
        work = {name: self._over_time(part) for name, part in parts.items()}
        return {**work, "positive": self._over_time(np.maximum(self.power.total, 0.0))}

    def _over_time(self, power: np.ndarray) -> float:
        whole = power.sum(axis=1)
        return float((0.5 * (whole[1:] + whole[:-1]) * np.diff(self.times)).sum())
