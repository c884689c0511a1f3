"""A robot of four legs, as small as a spec can be, and random stands of it."""

import numpy as np

SPEC = """
walkgen = 1
robot = {{ name = "stand", gravity = [0, 0, -9.80665] }}
generate = {{ functions = [{functions}]{more} }}
platforms = [{{ name = "body" }}]
legs = [{legs}]
{parameters}
[leg_designs.one]
dh = "classic"
joints = [{{ name = "slide", type = "prismatic", a = 0.1, alpha_deg = 0, d = 0.2 }}]
"""
INFEASIBLE = 5


def spec(*functions, legs=4, more="", parameters=""):
    mounted = ", ".join(f'{{ name = "leg_{number}", design = "one", platform = "body" }}' for number in range(legs))
    named = ", ".join(f'"{name}"' for name in functions)
    return SPEC.format(functions=named, legs=mounted, more=more, parameters=parameters)


def stands(count, feet=4, seed=0, slope=0.5, lean=0.05):
    """Feet around the origin on ground of random slopes, and loads that lean [count,...]."""
    generator = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(feet) + generator.uniform(-0.3, 0.3, (count, feet))) / feet
    points = np.stack([np.cos(angle), np.sin(angle), generator.uniform(-0.2, 0.2, (count, feet))], axis=-1) * 0.4
    tilted = np.concatenate([generator.uniform(-slope, slope, (count, feet, 2)), np.ones((count, feet, 1))], axis=-1)
    normals = tilted / np.linalg.norm(tilted, axis=-1, keepdims=True)
    force = np.concatenate([generator.uniform(-20, 20, (count, 2)), np.full((count, 1), -100.0)], axis=-1)
    moment = np.cross(generator.uniform(-lean, lean, (count, 3)), force)
    return points, normals, generator.uniform(0.3, 1.0, (count, feet)), np.concatenate([force, moment], axis=-1)


def balance(points, f, wrench):
    """What forces lack of carrying the load [...,6]."""
    return np.concatenate([f.sum(-2), np.cross(points, f).sum(-2)], axis=-1) + wrench
