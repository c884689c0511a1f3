"""Jinja templates, which lay out prepared lists and decide nothing."""

from pathlib import Path, PurePosixPath

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from walkgen.emit.artifact import Artifact

_ENVIRONMENT = Environment(
    loader=FileSystemLoader(Path(__file__).parent / "templates"),
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
    keep_trailing_newline=True,
    autoescape=False,  # noqa: S701 - the output is C and CMake, not HTML; names and comments are escaped before they come here
)


def lay_out(template: str, path: str, **values: object) -> Artifact:
    """Fill a template.

    Args:
        template: its file name in `templates/`.
        path: the artifact's path in the robot's folder.
        values: what the template names; a name left out is an error.
    """
    return Artifact(PurePosixPath(path), _ENVIRONMENT.get_template(template).render(values))
