"""The one `settle` that users call: it makes room for the whole path and gives what there is of it."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from walkgen.runtime.counted import Counted
from walkgen.signature import COUNTS

NAME = "settle"


@dataclass(frozen=True, eq=False, repr=False)
class Settle:
    """The stable pose that the robot slides to on three feet, and the way; `solve` is the robot's generated function."""

    solve: Counted

    def __call__(
        self, base_pose: Any, q: Any, feet: Any = None, wrench: Any = None, step: Any = None, most_steps: Any = None, **named: Any
    ) -> Any:
        """Leading dimensions are a batch.

        Args:
            base_pose: where it starts [4,4], world_T_platform; its feet are put on the terrain.
            q: its joint values, which stay [nq].
            feet: numbers of the three legs that it stands on [3]; all where it has three.
            wrench: on the robot in the world beside its weight [6]: force (N), moment about the origin (N m); 0 where left out.
            step: how far the fastest foot goes in a step (m).
            most_steps: when to give up.
            named: param [np].

        Returns:
            pose [4,4], status, normal_forces [3] (N), path [n,4,4], steps. The path ends with the pose; in a batch it is as long as the
            longest, and the others repeat their last pose.

        Raises:
            TypeError: no feet for a robot of more than three legs.
            ValueError: shapes that do not fit, or more steps than there is room for.
        """
        most = self._usual_steps if most_steps is None else most_steps
        poses = int(np.max(most, initial=0)) + 1
        if poses > COUNTS["poses"]:
            raise ValueError(f"{NAME}: most_steps is {poses - 1}; at most {COUNTS['poses'] - 1} are possible, go on from the last pose")
        pose, status, normal_forces, path, steps = self.solve(base_pose, q, feet, wrench, step, most, poses=poses, **named)
        kept = path[..., : int(np.max(steps, initial=0)) + 1, :, :]
        return pose, status, normal_forces, kept.astype(pose.dtype), steps

    @property
    def _usual_steps(self) -> int:
        return next(int(port.default[0]) for port in self.solve.signature.inputs if port.name == "most_steps")

    def __repr__(self) -> str:
        return f"<function {NAME!r} on three feet>"
