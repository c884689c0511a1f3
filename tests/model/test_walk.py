"""The 50-digit walk against the same walk in doubles, and against differences for the axes' directions."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from float_walk import assembled, close, frames, number
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from mpmath import mpf

from mechanisms.random_specs import specs
from walkgen.model import walk

SPECS = Path(__file__).parents[2] / "specs"


def random_q(mechanism, seed):
    generator = np.random.default_rng(seed)
    return generator.uniform(-np.pi, np.pi, sum(len(limb.joints) for limb in mechanism.limbs))


def assert_walks_agree(mechanism, seed):
    values = {parameter.name: number(parameter.default, {}) for parameter in mechanism.parameters}
    q = random_q(mechanism, seed)
    poses = [np.eye(4)] * len(mechanism.platforms)
    for limb in mechanism.limbs:
        own = q[mechanism.offset(limb) :][: len(limb.joints)]
        expected = frames(limb, own, values)
        found = [np.array(frame.tolist(), dtype=float) for frame in walk.limb_frames(mechanism, limb, list(own))]
        assert close(found, expected, 1e-13)
    for index in range(len(mechanism.platforms)):
        for chain in mechanism.ancestors(index):
            own = q[mechanism.offset(chain) :][: len(chain.joints)]
            poses[chain.child] = poses[chain.platform] @ frames(chain, own, values)[-1]
    found = [np.array(pose.tolist(), dtype=float) for pose in walk.platform_poses(mechanism, list(q))]
    assert close(found, poses, 1e-13)


@pytest.mark.parametrize("name", ["mero", "mero_star", "mero_leg_param", "solo12", "ambler_rrp"])
def test_shipped_robots(tmp_path, name):
    assert_walks_agree(assembled(tmp_path, (SPECS / f"{name}.toml").read_text(encoding="utf-8")), 1)


@settings(derandomize=True, deadline=None, max_examples=40, phases=[Phase.generate])
@given(specs(), st.integers(0, 1000))
def test_random_robots(text, seed):
    with TemporaryDirectory() as folder:
        assert_walks_agree(assembled(Path(folder), text), seed)


@settings(derandomize=True, deadline=None, max_examples=15, phases=[Phase.generate])
@given(specs(most_joints=4))
def test_axes_point_where_joints_go(text):
    """Of every joint: the axis is that of the small motion from q = 0, right-handed and positive for growing q."""
    step = 1e-6
    with TemporaryDirectory() as folder:
        mechanism = assembled(Path(folder), text)
    for limb in mechanism.limbs:
        for index, joint in enumerate(limb.joints):
            axis = np.array(walk.joint_axis(mechanism, limb, index, {}).tolist(), dtype=float).ravel()
            ahead, behind = (frames(limb, side * step * np.eye(len(limb.joints))[index])[-1] for side in (1, -1))
            slope = (ahead - behind) / (2 * step)
            if joint.kind == "prismatic":
                assert close(axis, slope[:3, 3], 1e-9)
            else:
                spin = slope[:3, :3] @ frames(limb, [0] * len(limb.joints))[-1][:3, :3].T
                assert close(axis, [spin[2, 1], spin[0, 2], spin[1, 0]], 1e-9)


def test_fifty_digits(tmp_path):
    """Three quarter turns and a sixth: the foot of mero_leg at exact angles, known in radicals."""
    mechanism = assembled(tmp_path, (SPECS / "mero_leg.toml").read_text(encoding="utf-8"))
    context = walk.CONTEXT
    foot = walk.limb_frames(mechanism, mechanism.legs[0], [context.pi / 6, context.pi / 3, -context.pi / 2])[-1]
    r = context.mpf("0.35") / 2 + context.mpf("0.40") * context.sqrt(3) / 2
    z = context.mpf("0.12") + context.mpf("0.35") * context.sqrt(3) / 2 - context.mpf("0.40") / 2
    for found, expected in zip((foot[0, 3], foot[1, 3], foot[2, 3]), (r * context.sqrt(3) / 2, r / 2, z), strict=True):
        assert abs(found - expected) < mpf(10) ** -48
