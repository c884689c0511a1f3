"""walkgen turns a walking robot described in TOML into closed-form C99, CasADi and NumPy code."""

import os

__version__ = "0.1.0"

os.environ.setdefault("SYMPY_CACHE_SIZE", "100000")  # sympy reads it once, when imported: its 1000 entries are few for a large robot
