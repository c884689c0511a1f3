"""Random expressions, explicit and implicit: the Programs in 40 digits against mpmath's own derivatives of the text."""

from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import pytest
from mpmath import mp

from oracles.backends import programs
from terrain.grounds import explicit, spec
from walkgen.graph.interpret import interpret
from walkgen.pipeline import programs_of

_LEAVES = ("x", "y", "0.3", "(2 - lift)", "pi/5", "lift")
_FORMS = (
    "({0} + {1})", "({0} - {1})", "({0}*{1})", "({0}/(2 + {1}**2))", "(-{0})", "sin({0})", "cos({0})", "tan({0}/(3 + {0}**2))",
    "sqrt(1 + {0}**2)", "hypot({0}, 1 + {1}**2)", "atan2({0}, 2 + {1}**2)", "(2 + {0}**2)**-2", "({0})**3/9",
)  # fmt: skip
_COUNT = 12


def expression(random: Random, depth: int) -> str:
    """A text that is defined everywhere."""
    if depth == 0 or random.random() < 0.1:
        return random.choice(_LEAVES)
    return random.choice(_FORMS).format(expression(random, depth - 1), expression(random, depth - 1))


def function(text: str) -> Callable[..., Any]:
    """The text with mpmath's functions, as Python reads it."""
    names = {name: getattr(mp, name) for name in ("sin", "cos", "tan", "sqrt", "hypot", "atan2", "pi")}
    decimals = text.replace("0.3", "(mpf(3)/10)")
    return eval(f"lambda x, y, lift: {decimals} + 0*x", {**names, "mpf": mp.mpf})  # noqa: S307 - a text made above


def expected(text: str, x: Any, y: Any, lift: Any) -> tuple[Any, list[Any], list[list[Any]]]:
    """Height, normal and the second fundamental form on the dual of (1, 0, f_x), (0, 1, f_y): f_ab / w."""
    f = function(text)
    value = f(x, y, lift)
    slopes = [mp.diff(lambda a, b: f(a, b, lift), (x, y), order) for order in ((1, 0), (0, 1))]
    w = mp.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)
    second = [[mp.diff(lambda a, b: f(a, b, lift), (x, y), order) / w for order in row] for row in (((2, 0), (1, 1)), ((1, 1), (0, 2)))]
    return value, [-slopes[0] / w, -slopes[1] / w, 1 / w], second


@pytest.mark.parametrize("kind", ["explicit", "implicit"])
def test_random_expressions_to_30_digits(tmp_path: Path, kind: str) -> None:
    random = Random(11)
    texts = [expression(random, 4) for _ in range(_COUNT)]
    strips = [f"domain = {{ x = [{index}, {index}.875] }}" for index in range(_COUNT)]
    moved = [text.replace("x", f"(x - {index})").replace("(x - 0)", "x") for index, text in enumerate(texts)]
    keys = [explicit(text, strip) for text, strip in zip(moved, strips, strict=True)]
    if kind == "implicit":
        keys = [f'surface = "implicit"\nf = "3*({text} - z)"\n{strip}' for text, strip in zip(moved, strips, strict=True)]
    path = tmp_path / "spec.toml"
    path.write_text(
        spec(*keys, parameters="lift = { value = 0.5, runtime = true }", functions=("height", "normal", "tangents", "curvature"))
    )
    with mp.workdps(40):
        for index, text in enumerate(texts):
            x, y, lift = map(mp.mpf, (random.random() * 0.875, random.uniform(-1, 1), random.uniform(0.1, 1)))
            z, n, second = expected(text, x, y, lift)
            found = values(path, kind, [x + index, y, z], lift)
            flat = [found["tangents"][0:2], found["tangents"][3:5]]
            bent = [sum(a[i] * second[i][j] * b[j] for i in range(2) for j in range(2)) for a in flat for b in flat]
            pairs = zip([*found["height"], *found["normal"], *found["curvature"]], [z, *n, *bent], strict=True)
            assert max(abs(a - b) / (1 + abs(b)) for a, b in pairs) < mp.mpf(10) ** -30, text


_KNOWN: dict[Path, dict[str, Any]] = {}


def values(path: Path, kind: str, p: list[Any], lift: Any) -> dict[str, list[Any]]:
    """Every output of the terrain's functions at a point; of implicit patches that of the kernel behind the search."""
    if path not in _KNOWN:
        whole = (
            programs(path)
            if kind == "explicit"
            else {body.signature.full_name: body.calls[-1].callee for body in programs_of(path) if hasattr(body, "calls")}
        )
        _KNOWN[path] = {name.removeprefix("rob_terrain_"): program for name, program in whole.items() if "terrain" in name}
    found = {}
    for name, program in _KNOWN[path].items():
        located = {port.name: [p[2]] for port in program.signature.inputs if port.name.startswith("at_")}
        outputs = interpret(program, {"p": p, "param": [lift], **located}, mp)
        found[name] = next(iter(outputs.values()))
    return found
