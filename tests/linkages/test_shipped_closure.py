"""Every loop of the shipped legs closes to rounding."""

from pathlib import Path

import numpy as np
import pytest

from linkages.closure import Closure
from linkages.placed import as_unknowns, code_of
from linkages.theory import BOXES

SPECS = Path(__file__).parents[2] / "specs"
DRIVES = BOXES | {"hydraulic_leg": ((0.25, 0.25), (0.45, 0.45)), "minitaur": ((-np.pi, -np.pi), (np.pi, np.pi))}
SIZES = {"odex": 1.05, "bessonov": 0.8, "garrec": 0.9, "pantograph": 0.8, "hydraulic_leg": 0.8, "minitaur": 0.315}
"""Of the stretched legs (m)."""
YAWED = ("odex", "bessonov", "garrec", "hydraulic_leg")


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.nightly) if name == "bessonov" else name for name in DRIVES])
def test_loops_close(tmp_path, name):
    text = (SPECS / f"{name}.toml").read_text(encoding="utf-8")
    drives = np.random.default_rng(11).uniform(*DRIVES[name], (2000, len(DRIVES[name][0])))
    q = np.c_[np.zeros(len(drives)), drives] if name in YAWED else drives
    leg = next(iter(value for key, value in code_of(text, ("foot_position",), tmp_path).items() if key.endswith("_poses")))
    poses = leg(q)
    closes = np.isfinite(poses).all((1, 2))
    assert closes.sum() >= 1000
    residual, _ = Closure(text, np.empty((closes.sum(), 0)), drives[closes]).equations(as_unknowns(poses[closes]))
    assert np.abs(residual).max() <= 1e-14 * SIZES[name]
    assert np.abs(np.hypot(poses[closes, :, 2], poses[closes, :, 3]) - 1).max() <= 1e-14
