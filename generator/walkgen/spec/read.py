"""From a TOML file to a RobotSpec: text, shapes, then every rule of the language, and all problems of a file at once."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from pydantic import ValidationError

from walkgen.errors import Problem, SpecError, UnsupportedMechanism
from walkgen.spec.checks_forms import check_forms
from walkgen.spec.checks_gait import check_gaits
from walkgen.spec.checks_joints import check_joints, check_units
from walkgen.spec.checks_names import check_joined_names, check_names, check_texts
from walkgen.spec.checks_sole_design import check_sole_designs
from walkgen.spec.checks_soles import check_soles
from walkgen.spec.checks_terrain import check_height_maps, check_terrain
from walkgen.spec.checks_tree import check_references, check_tree
from walkgen.spec.checks_values import check_expressions, check_inertias, check_ranges
from walkgen.spec.document import Document, open_document
from walkgen.spec.evaluate import numbers_of
from walkgen.spec.expand import expanded_spec
from walkgen.spec.positions import Positions
from walkgen.spec.problems import Finding, dotted
from walkgen.spec.schema import RobotSpec
from walkgen.spec.shapes import salvage
from walkgen.spec.table import Path as Key

_MOST_PROBLEMS = 200
_UNSUPPORTED = "WG150"


def read(path: Path) -> RobotSpec:
    """The robot described in a TOML file, linkages in the long form.

    Raises:
        SpecError: every problem of the file, each with its place and cure.
        UnsupportedMechanism: nothing is wrong but that the robot is of a kind that is not supported.
    """
    document = open_document(path)
    try:
        spec = RobotSpec.model_validate(document.tables)
    except ValidationError:
        raise _error(document, _broken(document)) from None
    findings = tuple(findings_of(spec, path.parent))
    if findings:
        raise _error(document, findings)
    return expanded_spec(spec)


def findings_of(spec: RobotSpec, folder: Path) -> Iterator[Finding]:
    """Every rule that a well-formed spec breaks; `folder` is where its height maps are."""
    numbers, parameters = numbers_of(spec.parameters)
    return chain(
        parameters,
        check_names(spec),
        check_joined_names(spec),
        check_texts(spec),
        check_references(spec),
        check_tree(spec),
        check_joints(spec, numbers),
        check_forms(spec, numbers),
        check_soles(spec, numbers),
        check_sole_designs(spec, numbers),
        check_units(spec, numbers),
        check_expressions(spec, numbers),
        check_ranges(spec, numbers),
        check_inertias(spec, numbers),
        check_terrain(spec, numbers),
        check_height_maps(spec, numbers, folder),
        check_gaits(spec, numbers),
    )


def _broken(document: Document) -> tuple[Finding, ...]:
    """What has the wrong shape, and what else is wrong with the rest; consequences of a wrong shape are left out."""
    rest, shapes, blamed = salvage(document.tables)
    others = findings_of(rest, Path(document.file).parent) if rest is not None else iter(())
    return (*shapes, *(finding for finding in others if not _follows(finding, blamed)))


def _follows(finding: Finding, blamed: frozenset[Key]) -> bool:
    """Whether the finding is about something that was left out, or rests on it."""
    above = (finding.path[:length] for length in range(1, len(finding.path) + 1))
    return any(path in blamed for path in (*above, *finding.because))


def _error(document: Document, findings: tuple[Finding, ...]) -> SpecError | UnsupportedMechanism:
    positions = Positions(document)
    problems = [_problem(finding, positions) for finding in dict.fromkeys(findings)]
    problems.sort(key=lambda problem: (problem.place.line, problem.place.column) if problem.place else (0, 0))
    if len(problems) > _MOST_PROBLEMS:
        problems[_MOST_PROBLEMS:] = [Problem("WG106", "there are more problems than are listed", "mend those above first")]
    kind = UnsupportedMechanism if all(finding.code == _UNSUPPORTED for finding in findings) else SpecError
    return kind(*problems)


def _problem(finding: Finding, positions: Positions) -> Problem:
    table = finding.path[:-1] if finding.code in {"WG110", "WG111"} else finding.path
    prefix = f"{dotted(table)}: " if table else ""
    return Problem(finding.code, prefix + finding.message, finding.cure, positions.place(finding.path))
