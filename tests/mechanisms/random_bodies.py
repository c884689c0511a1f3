"""Bodies for random robots: links and platforms with any inertia, some without, some that no real body has."""

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import strategies as st

from mechanisms.random_specs import specs

Draw = Callable[[st.SearchStrategy[Any]], Any]


def body(seed: int) -> str:
    """Mass, centre of mass and inertia of five random particles, or, every fourth time, an inertia that no real body has."""
    generator = np.random.default_rng(seed)
    com = generator.normal(size=3) * 0.2
    points, masses = generator.normal(size=(5, 3)) * 0.1, generator.uniform(0.05, 0.5, 5)
    points -= masses @ points / masses.sum()
    tensor = np.einsum(
        "i,ijk->jk", masses, np.einsum("ij,ij->i", points, points)[:, None, None] * np.eye(3) - points[:, :, None] * points[:, None]
    )
    if seed % 4 == 0:
        tensor = generator.normal(size=(3, 3)) * 0.2
        tensor = tensor @ tensor.T
    if seed % 3 == 0:  # symmetric bodies have zeros to be found
        tensor, com = np.diag(np.diag(tensor)), com * np.array([1.0, 0.0, 0.0])
    six = [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]]
    texts = [", ".join(f"{value:.6g}" for value in values) for values in (com, six)]
    return f"mass = {masses.sum():.6g}, com = [{texts[0]}], inertia = [{texts[1]}], allow_unphysical = true"


@st.composite
def specs_with_bodies(draw: Draw, share: float = 0.7, **options: Any) -> str:
    """A random robot whose links have bodies, about the `share` of them; the root platform always has one."""
    seed = draw(st.integers(0, 2**32 - 1))
    generator = np.random.default_rng(seed)
    lines = []
    for line in draw(specs(**options)).splitlines():
        lines.append(line)
        given = generator.random() < share
        if line.startswith("type = ") and given:
            lines.append(f"link = {{ {body(int(generator.integers(2**31)))} }}")
        if line == 'name = "base"' or (line.startswith("parent = ") and given):
            lines += body(int(generator.integers(2**31))).replace("], ", "]\n").replace(", com", "\ncom").splitlines()
    lines = [
        line.replace("gravity = [0.0, 0.0, -9.80665]", f"gravity = [{', '.join(f'{g:.4f}' for g in generator.normal(size=3) * 5)}]")
        for line in lines
    ]
    return "\n".join(lines) + "\n"
