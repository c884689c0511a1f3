"""The package files: what loads lazily, and stubs that a type checker accepts and that know the robot's own names."""

import subprocess
import sys
from dataclasses import replace

import pytest

from mechanisms.hand_programs import guarded_inverse, made, shapes
from walkgen.emit.artifact import RobotCode
from walkgen.emit.casadi_printer import casadi_artifact
from walkgen.emit.python_files import package_artifacts
from walkgen.model.mechanism import Limb, Mechanism, Platform
from walkgen.signature import Port
from walkgen.spec.scalar import exact


def owned(program, owner, *inputs):
    signature = program.signature
    return replace(program, signature=replace(signature, owner=owner, inputs=(*signature.inputs, *inputs), doc='Says """ \\ é.'))


PARAM = Port("param", (2,))
ROBOT = Mechanism(
    "toy",
    'A """toy""" \\',
    (exact(0),) * 3,
    (Platform("front", None, None),),
    (),
    (Limb("left", 0, (), (), ()), Limb("right", 0, (), (), ()), Limb("tail", 0, (), (), ())),
    (),
    (),
)
CODE = RobotCode(
    ROBOT,
    (owned(shapes(), "left"), owned(shapes(), "right"), owned(guarded_inverse(), "tail", PARAM), owned(guarded_inverse(), "")),
    "0" * 64,
)


def package(folder, code=CODE, name="toy"):
    place = folder / name
    place.mkdir()
    for artifact in (*package_artifacts(code), casadi_artifact(replace(code, functions=(shapes(),)))):
        (place / artifact.path).write_text(artifact.text, encoding="utf-8")


def python(folder, script):
    return subprocess.run([sys.executable, "-c", script], cwd=folder, check=True, capture_output=True, text=True).stdout


SCRIPT = """import toy
reveal_type(toy.legs["left"].shapes([1, 2], [[1, 2, 3]] * 2, 1)[3])
toy.legs["tail"].guarded(1.0, 1, param=[1, 2])
reveal_type(toy.guarded(1.0, 1))
toy.legs["wing"]
toy.legs["left"].guarded(1.0, 1)
toy.legs["tail"].guarded(1.0, 1, [1, 2])
print(toy.name, toy.robot.legs)
"""


def test_stub_is_strictly_typed_and_knows_the_robot(tmp_path):
    pytest.importorskip("mypy", reason="the stub is checked where the dev extra is installed")
    variants = {"toy": CODE, "toy_single": replace(CODE, float32=True), "toy_empty": replace(CODE, functions=())}
    for name, code in variants.items():
        package(tmp_path, code, name)
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", "--no-incremental", *(f"{name}/__init__.pyi" for name in variants), "script.py"]
    lines = subprocess.run(command, cwd=tmp_path, check=False, capture_output=True, text=True).stdout.splitlines()
    assert [line.split(": error:")[0] for line in lines if ": error:" in line] == ["script.py:5", "script.py:6", "script.py:7"], lines
    statuses, results = (line for line in lines if "Revealed type" in line)
    assert "signedinteger" in statuses or "int32" in statuses
    assert "tuple" in results


def test_attributes_come_from_the_loaded_robot(tmp_path):
    package(tmp_path)
    script = """
import sys, types
runtime = types.ModuleType("walkgen.runtime")
loads = []
def load(folder):
    loads.append(folder.name)
    return types.SimpleNamespace(name="toy", legs={"left": 1}, _hidden=0)
runtime.load = load
sys.modules["walkgen.runtime"] = runtime
import toy
assert not loads
assert toy.legs["left"] == 1 and toy.robot.name == toy.name == "toy"
assert loads == ["toy"]
assert "legs" in dir(toy) and "robot" in dir(toy) and "_hidden" not in dir(toy)
try:
    toy.wings
except AttributeError as error:
    print(error)
"""
    assert "wings" in python(tmp_path, script)


def test_casadi_file_is_imported_without_loading(tmp_path):
    package(tmp_path)
    script = "import sys; sys.modules['walkgen'] = None; from toy import toy_casadi; print(toy_casadi.FUNCTIONS)"
    assert python(tmp_path, script) == "('leg_shapes',)\n"


def test_same_bytes():
    assert package_artifacts(CODE) == package_artifacts(replace(CODE))


def test_limbs_with_other_functions_have_other_classes():
    other = replace(CODE, functions=(*CODE.functions, made("extra", (), (Port("y"),), (shapes().ops[9],), (0,))))
    assert "class _Leg2:" in package_artifacts(other)[1].text
