"""walkgen turns a walking robot described in TOML into closed-form C99, CasADi and NumPy code."""

__version__ = "0.1.0"
