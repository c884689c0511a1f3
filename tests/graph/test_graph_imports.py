"""sympy has a last line: only lowering may import it."""

import subprocess
import sys

import pytest

FREE = ("program", "number", "passes", "interpret", "differentiate", "routines")


@pytest.mark.parametrize("module", FREE)
def test_sympy_is_not_imported(module):
    code = f"import sys, walkgen.graph.{module}; sys.exit('sympy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
