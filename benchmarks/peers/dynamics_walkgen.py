"""walkgen's C of specs/mero_leg.toml and specs/mero.toml, only the measured functions generated."""

import hashlib

from motions import FUNCTIONS, DynamicFunction
from peers.dynamics_source import HEAD, adapter, core
from peers.source import HERE, Peer, Source
from trimmed import write_spec
from walkgen import pipeline, toolchain

OUTPUT = HERE.parent / "_build" / "dynamics"
CALLS = {
    "leg_inverse_dynamics": "mero_leg_leg_inverse_dynamics",
    "leg_mass_matrix": "mero_leg_leg_mass_matrix",
    "leg_forward_dynamics": "mero_leg_leg_forward_dynamics",
    "leg_bias_acceleration": "mero_leg_leg_foot_bias_acceleration",
    "mero_inverse_dynamics": "mero_floating_inverse_dynamics",
    "mero_mass_matrix": "mero_floating_mass_matrix",
}
ASKED = {
    "mero_leg": (
        *("inverse_dynamics", "mass_matrix", "forward_dynamics"),
        *("foot_bias_acceleration", "inverse_velocity_acceleration"),
    ),
    "mero": ("floating_inverse_dynamics", "floating_mass_matrix"),
}


_RATES = "    (void)mero_leg_leg_inverse_velocity_acceleration(q_bent, v, a, out, out + 3);"
"""It decides a status."""


def _core(function: DynamicFunction) -> str:
    if function.name not in CALLS:
        return core(function, _RATES)
    arguments = ", ".join([*dict(function.inputs), "out"])
    return core(function, f"    {CALLS[function.name]}({arguments});")


def _sources(spec: str, robot: str) -> tuple[Source, ...]:
    folder = pipeline.build(write_spec(spec, ASKED[spec], OUTPUT), OUTPUT, pipeline.BuildOptions(targets=("c",))).folder
    functions = [function for function in FUNCTIONS if function.robot == robot]
    cores = "\n".join(map(_core, functions)) + adapter(
        functions, lambda function: f"{CALLS[function.name]}_batch" if function.name in CALLS else ""
    )
    included = hashlib.sha256("".join(path.read_text() for path in sorted(folder.glob("*.h"))).encode()).hexdigest()
    text = f"/* headers {included} */\n{(folder / f'{spec}.c').read_text()}\n{HEAD}{cores}\n"
    return (
        Source("walkgen", "default flags", text, includes=(folder,), flags=toolchain.FLAGS),
        Source("walkgen", "spec", text, includes=(folder,)),
    )


PEER = Peer("walkgen", lambda: (*_sources("mero_leg", "leg"), *_sources("mero", "mero")))
