"""Pieces of URDF text, fixed and random, for the tests of import and export."""

from hypothesis import strategies as st

LIMIT = '<limit lower="-7" upper="7" velocity="3.5" effort="40"/>'
LENGTHS = st.integers(-400, 400).map(lambda n: f"{n / 1000}")
ANGLES = st.one_of(
    st.sampled_from(["0", "1.5707963267948966", "-1.5707963267948966", "3.14159265358979312"]),
    st.integers(-3000, 3000).map(lambda n: f"{n / 1000}"),
)
AXES = st.sampled_from(["1 0 0", "0 1 0", "0 0 1", "0 0 -1", "1 1 0", "-0.36 0.48 0.8", "1 2 3"])


def inertial(mass, origin='<origin xyz="0.01 -0.02 0.03" rpy="0.1 0.2 0.3"/>', moments=("0.02", "0.03", "0.04", "0.001", "0", "-0.002")):
    keys = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), moments, strict=True)
    return f'<inertial>{origin}<mass value="{mass}"/><inertia {" ".join(f"{key}={value!r}" for key, value in keys)}/></inertial>'


def link(name, inner=""):
    return f'<link name="{name}">{inner}</link>'


def joint(name, kind, parent, child, inner=""):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inner}</joint>'


@st.composite
def origins(draw):
    xyz, rpy = (" ".join(draw(numbers) for _ in range(3)) for numbers in (LENGTHS, ANGLES))
    return draw(st.sampled_from([f'<origin xyz="{xyz}" rpy="{rpy}"/>', f'<origin xyz="{xyz}"/>', ""]))


@st.composite
def bodies(draw):
    mass = draw(st.sampled_from(["", "0.25", "1.5"]))
    return inertial(mass, draw(origins())) if mass else ""


@st.composite
def branching(draw):
    """Any tree of fixed and movable joints, as (parts of the text, the links at its ends)."""
    count = draw(st.integers(3, 14))
    parts, parents = [link("l0", inertial("3.5"))], set()
    for index in range(1, count):
        parent = draw(st.integers(max(0, index - 4), index - 1))
        parents.add(parent)
        kind = draw(st.sampled_from(["fixed", "revolute", "revolute", "prismatic"]))
        inner = draw(origins()) + ("" if kind == "fixed" else f'<axis xyz="{draw(AXES)}"/>{LIMIT}')
        parts += [link(f"l{index}", draw(bodies())), joint(f"j{index}", kind, f"l{parent}", f"l{index}", inner)]
    return parts, tuple(f"l{index}" for index in range(1, count) if index not in parents)
