"""Legs and arms as their specs' own Denavit-Hartenberg rows: what a solver answers is judged by a forward walk of its own."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chain:
    """Joints base to foot: `R` or `P` each, and the classic rows a, alpha, d, theta (m, rad); the last frame is the foot's."""

    kinds: str
    rows: tuple[tuple[float, float, float, float], ...]
    limits: tuple[tuple[float, float], ...]
    """Lowest and highest value; a full turn where the spec gives none."""

    def frames(self, q: Array) -> Array:
        """Base and moved frames [rows,n+1,4,4] for joint values [rows,n]."""
        found = [np.broadcast_to(np.eye(4), (len(q), 4, 4))]
        for value, kind, (length, twist, offset, turn) in zip(q.T, self.kinds, self.rows, strict=True):
            angle, rise = (turn + value, offset + 0 * value) if kind == "R" else (turn + 0 * value, offset + value)
            found.append(found[-1] @ _classic(length, twist, rise, angle))
        return np.stack(found, axis=1)

    def foot(self, q: Array) -> Array:
        """Foot poses [rows,4,4]."""
        return self.frames(q)[:, -1]


def _classic(length: float, twist: float, offset: Array, angle: Array) -> Array:
    """Rz(angle) Tz(offset) Tx(length) Rx(twist), a matrix a row [rows,4,4]."""
    c, s, ca, sa, one = np.cos(angle), np.sin(angle), np.cos(twist), np.sin(twist), np.ones_like(angle)
    matrix = [
        [c, -s * ca, s * sa, length * c],
        [s, c * ca, -c * sa, length * s],
        [0 * one, sa * one, ca * one, offset],
        [0 * one, 0 * one, 0 * one, one],
    ]
    return np.moveaxis(np.array(matrix), -1, 0)


def read_chain(spec: Path, leg: str) -> Chain:
    """One unmounted leg of a spec that gives classic rows and no foot point."""
    content = tomllib.loads(spec.read_text())
    mounted = next(entry for entry in content["legs"] if entry["name"] == leg)
    design = content["leg_designs"][mounted["design"]]
    if design["dh"] != "classic" or "mount" in mounted or "foot" in design:
        raise ValueError(f"{spec.name}: {leg} is more than classic rows")
    joints = design["joints"]
    rows = tuple((joint["a"], _angle(joint, "alpha"), joint["d"], _angle(joint, "theta")) for joint in joints)
    return Chain("".join(joint["type"][0].upper() for joint in joints), rows, tuple(map(_limits, joints)))


def _angle(joint: dict[str, Any], key: str) -> float:
    return float(np.radians(joint[f"{key}_deg"])) if f"{key}_deg" in joint else joint.get(key, 0.0)


def _limits(joint: dict[str, Any]) -> tuple[float, float]:
    if "limits_deg" in joint:
        low, high = np.radians(joint["limits_deg"])
        return float(low), float(high)
    low, high = joint.get("limits", (-np.pi, np.pi))
    return low, high
