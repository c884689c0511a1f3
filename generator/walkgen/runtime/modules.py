"""Runs a generated Python file by its path, without installing it or touching sys.path."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType


def execute(path: Path) -> ModuleType:
    """The file as a module of its own.

    Raises:
        FileNotFoundError: there is no such file.
        ImportError: it needs something that is not installed.
    """
    spec = spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise AssertionError(f"not a Python file: {path}")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
