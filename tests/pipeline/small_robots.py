"""Spec texts of robots that build in a second, and how to look at what a build left on disk."""

from pathlib import Path

FILES = ("robot.h", "robot.c", "robot_python.c", "robot_numpy.py", "robot_casadi.py", "__init__.py", "manifest.json")


def text(thigh: str = "0.35", functions: str = '["foot_position", "inverse"]', name: str = "robot") -> str:
    """One yaw-pitch-pitch leg; a description that is not ASCII."""
    return f'''walkgen = 1
[robot]
name = "{name}"
description = "Ein Bein, 35 cm lang; größer wäre 大きい"
gravity = [0.0, 0.0, -9.80665]
[generate]
functions = {functions}
[leg_designs.leg]
dh = "classic"
joints = [
  {{ name = "yaw", type = "revolute", a = 0.05, alpha_deg = 90, d = 0.12 }},
  {{ name = "thigh", type = "revolute", a = {thigh}, alpha_deg = 0, d = 0.0 }},
  {{ name = "shank", type = "revolute", a = 0.40, alpha_deg = 0, d = 0.01 }},
]
[[platforms]]
name = "body"
[[legs]]
name = "leg"
design = "leg"
platform = "body"
mount = {{ xyz = [0.1, 0.2, 0.0], rpy_deg = [0, 0, 37] }}
'''


def written(path: Path, content: str) -> Path:
    """The spec on disk."""
    path.write_text(content, encoding="utf-8")
    return path


def committed(folder: Path) -> dict[str, bytes]:
    """Every file of a robot but the compiled ones."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files if "_build" not in path.relative_to(folder).parts}


def tree(*folders: Path) -> dict[str, bytes]:
    """Every file and folder below."""
    return {str(path): path.read_bytes() if path.is_file() else b"" for folder in folders for path in sorted(folder.rglob("*"))}
