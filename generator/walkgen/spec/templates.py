"""Starting specs for `walkgen new`, each a valid robot with every choice explained."""

from importlib.resources import files

from walkgen.errors import Problem, WalkgenError
from walkgen.spec.problems import did_you_mean, shown

KINDS = ("leg", "hexapod", "quadruped", "modular")


def template(kind: str) -> str:
    """The commented spec of a kind of robot.

    Raises:
        WalkgenError: no such kind.
    """
    if kind not in KINDS:
        problem = Problem("WG170", f'there is no starting spec "{shown(kind)}"', did_you_mean(kind, KINDS, "kinds"))
        raise WalkgenError(problem)
    return files("walkgen.spec").joinpath("templates", f"{kind}.toml").read_text("utf-8")
