"""The command line: each command reads its arguments, calls one stage and prints; what is heavy is imported where it is used."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from walkgen import __version__
from walkgen.arguments import TO_FILE, Body, Format, Output, SoleName, Specs, Stage, Verify, targets_of
from walkgen.collector import uncollected
from walkgen.errors import Problem, WalkgenError
from walkgen.terminal import as_json, count, deliver, print_build, print_walk, progress_of, report, write_new

if TYPE_CHECKING:
    from walkgen.pipeline import BuildOptions
    from walkgen.spec.schema import RobotSpec

DIFFERENCE, USER_ERROR = 1, 2
os.environ.setdefault("SYMPY_CACHE_SIZE", "None")  # a derivation meets far more terms again than sympy keeps


class _Commands(TyperGroup):
    """Turns what the user can mend into its report and exit code 2; anything else is our bug and keeps its traceback."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except WalkgenError as error:
            report(error.problems)
            raise typer.Exit(USER_ERROR) from None


app = typer.Typer(
    cls=_Commands,
    help="Closed-form kinematics of walking robots, from one TOML file to C99, CasADi and NumPy code.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(asked: bool) -> None:
    if asked:
        typer.echo(f"walkgen {__version__}")
        raise typer.Exit


@app.callback()
def _walkgen(
    version: Annotated[bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")] = False,
) -> None:
    """Closed-form kinematics of walking robots, from one TOML file to C99, CasADi and NumPy code."""


@app.command()
@uncollected()
def build(
    specs: Specs,
    output: Output = Path("generated"),
    check: Annotated[bool, typer.Option("--check", help="Change nothing; name the files that a build would change (exit code 1).")] = False,
    float32: Annotated[bool, typer.Option("--float32", help="Add a single-precision library.")] = False,
    planar: Annotated[bool, typer.Option("--planar", help="Add C functions of component-major arrays, `_planar` beside `_batch`.")] = False,
    targets: Annotated[str, typer.Option(metavar="LIST", help="Any of c,casadi,numpy instead of the spec's targets.")] = "",
    no_fma: Annotated[bool, typer.Option("--no-fma", help="No fused multiply-add: equal bits on every machine.")] = False,
    verify: Annotated[Verify, typer.Option(help="Run the self-test; full: with strict warnings and sanitizers.")] = Verify.NONE,
) -> None:
    """Generate and compile each robot into DIR/<robot>/."""
    from walkgen import pipeline, selftest
    from walkgen.toolchain import FLAGS

    options = pipeline.BuildOptions(targets=targets_of(targets), float32=float32, fma=not no_fma, planar=planar)
    if check:
        _check_stale(specs, output, options)
        return

    failed: list[Path] = []

    def one(spec: Path) -> None:
        with progress_of(spec) as progress:
            built = pipeline.build(spec, output, options, progress)
        report(built.notices)
        print_build(built)
        if verify is not Verify.NONE and selftest.run(built.folder, selftest.STRICT if verify is Verify.FULL else FLAGS):
            failed.append(built.folder)

    _for_each(specs, one)
    if failed:
        raise typer.Exit(DIFFERENCE)


def _check_stale(specs: list[Path], output: Path, options: "BuildOptions") -> None:
    from walkgen import pipeline

    found: list[str] = []

    def one(spec: Path) -> None:
        for name in pipeline.stale(spec, output, options):
            found.append(name)
            elsewhere = "" if output == Path("generated") else f" -o {output}"
            typer.echo(f"{name} is stale; run: walkgen build {spec}{elsewhere}")

    _for_each(specs, one)
    if found:
        raise typer.Exit(DIFFERENCE)
    typer.echo(f"{count(len(specs), 'robot')} up to date")


@app.command(name="check")
def check_specs(
    specs: Annotated[list[Path] | None, typer.Argument(metavar="SPEC", help="Robot specs (TOML).")] = None,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of the spec language, for editors.")] = False,
    form: Annotated[Format, typer.Option("--format", help="How problems are printed.")] = Format.TEXT,
) -> None:
    """Validate only: every problem at once."""
    from walkgen.spec.read import read
    from walkgen.spec.schema import schema_json

    if schema:
        typer.echo(schema_json(), nl=False)
        return
    if not specs:
        raise typer.BadParameter("name at least one spec, or ask for the --schema")
    problems = _problems(specs, lambda spec: _noticed(spec, read(spec)))
    if form is Format.JSON:
        typer.echo(json.dumps([as_json(problem) for problem in problems], indent=1))
    elif problems:
        report(problems)
    else:
        typer.echo(f"{count(len(specs), 'spec')} without a problem")
    if problems:
        raise typer.Exit(USER_ERROR)


def _noticed(path: Path, spec: "RobotSpec") -> None:
    """Say what a user should know of a good spec; only linkages have anything to tell, and need the algebra system for it."""
    if any(design.planar for design in spec.leg_designs.values()):
        from walkgen.pipeline import notices_of

        report(notices_of(path, spec))


@app.command()
def show(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="A robot spec (TOML).")],
    stage: Annotated[Stage | None, typer.Option(help="Which product to show; the mechanism, or the equations of --function.")] = None,
    function: Annotated[
        str, typer.Option(metavar="NAME", help="Only this function, such as foot_position or mero_front_left_inverse.")
    ] = "",
) -> None:
    """Show any stage's product: equations, the class of the inverse and why, operation counts."""
    from walkgen import show as text

    chosen = stage or (Stage.FUNCTIONS if function else Stage.MECHANISM)
    typer.echo(text.show(spec, chosen.value, function))


@app.command()
def gait(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="A robot spec (TOML) with a [gait].")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="walk.html to look at, walk.csv to reckon with.")
    ] = None,
    png: Annotated[Path | None, typer.Option("--png", metavar="FILE.png", help="A still picture.")] = None,
    name: Annotated[str, typer.Option("--gait", metavar="NAME", help="Which of the spec's gaits; its first where left out.")] = "",
    terrain: Annotated[
        str, typer.Option(metavar="GROUND", help="flat, slope:DEGREES, map:FILE:SPACING, or a height in x and y; the spec's, else flat.")
    ] = "",
    body: Annotated[Body | None, typer.Option(help="What the platform does before a leg lifts, instead of what the gait says.")] = None,
    margin: Annotated[float | None, typer.Option(metavar="M", help="The least static stability margin; the gait's, else 0.")] = None,
    cycles: Annotated[int, typer.Option(metavar="N", help="Periods to walk.")] = 3,
    rate: Annotated[float, typer.Option(metavar="HZ", help="Instants in a second.")] = 100.0,
    from_rest: Annotated[bool, typer.Option("--from-rest", help="Start and stop; else walk steadily.")] = False,
    give: Annotated[float, typer.Option(metavar="M", help="How far ground and feet give, for legs with a path of their own.")] = 0.0,
    heading: Annotated[float, typer.Option(metavar="DEG", help="Of the course, from the world's x axis to its y axis.")] = 0.0,
    mu: Annotated[float | None, typer.Option(metavar="MU", help="Coefficient of friction; the ground's where it says, else 0.7.")] = None,
    adapt: Annotated[bool, typer.Option("--adapt", help="Adapt the connecting chains to the footholds; else hold them straight.")] = False,
) -> None:
    """Simulate a walk: animation, table, picture; exit code 1 where the robot cannot walk so, with what stands against it."""
    from walkgen import walking
    from walkgen.walking_request import Wanted

    asked = Wanted(name, terrain, body.value if body else "", margin, cycles, rate, from_rest, adapt, give, heading, mu)
    with progress_of(spec) as progress:
        result = walking.walked(spec, asked, progress)
        progress("write")
        if output is not None:
            write_new(output, walking.written(result, output))
        if png is not None:
            write_new(png, walking.pictured(result))
    print_walk(result.walk, [file for file in (output, png) if file is not None])
    if not result.walk.feasible:
        raise typer.Exit(DIFFERENCE)


@app.command()
def design(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="A robot spec (TOML) with a [balance.NAME] or [sole_design.NAME].")],
    balance: Annotated[str, typer.Option("--balance", metavar="NAME", help="Which of the spec's balances; its only one if left out.")] = "",
    sole: SoleName = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="SPEC.toml", help="The spec with what was found.")] = None,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE", help="What is left: .html to look into, .png.")] = None,
    cam: Annotated[Path | None, typer.Option("--cam", metavar="FILE", help="The cam's profile: .csv, .svg, .dxf.")] = None,
    starts: Annotated[int | None, typer.Option(metavar="N", help="Random starts, instead of the spec's number.")] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Of the random starts.")] = 0,
) -> None:
    """Search springs that balance a leg, a cam, or a sole to roll on: a table before and after, plots, the spec with the values found."""
    from walkgen import designing

    designing.check_suffixes(plot, cam)
    with progress_of(spec) as progress:
        found = designing.designed(spec, balance, sole, starts, seed, progress)
    typer.echo(designing.reported(found))
    for file, content in designing.files(spec, found, output, plot, cam):
        write_new(file, content)
        typer.echo(f"{file} written", err=True)


@app.command()
def new(kind: Annotated[str, typer.Argument(metavar="KIND", help="leg, hexapod, quadruped or modular.")]) -> None:
    """Print a commented spec to start from."""
    from walkgen.spec.templates import template

    typer.echo(template(kind), nl=False)


@app.command()
def test(folder: Annotated[Path, typer.Argument(metavar="DIR", help="A built robot, such as generated/mero.")]) -> None:
    """Compile and run the self-test that was generated with the robot; its numbers come from a 40-digit matrix walk."""
    from walkgen.selftest import run

    raise typer.Exit(run(folder))


@app.command(name="import")
def import_urdf(
    file: Annotated[Path, typer.Argument(metavar="FILE.urdf", help="The robot.")],
    foot: Annotated[list[str] | None, typer.Option(metavar="LINK", help="A leg's last link; once for each leg.")] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="SPEC.toml", help=TO_FILE)] = None,
) -> None:
    """Turn a URDF into a spec: a leg for each foot, connecting chains where feet share joints, fixed joints folded."""
    from walkgen.spec.urdf import convert

    imported = convert(file, tuple(foot or ()))
    report(imported.warnings)
    for source, name in imported.names:
        typer.echo(f"{source} -> {name}", err=True)
    deliver(imported.toml, output, "walkgen build")


@app.command()
def export(
    spec: Annotated[Path, typer.Argument(metavar="SPEC", help="A robot spec (TOML).")],
    urdf: Annotated[bool, typer.Option("--urdf", help="The format: URDF, runtime parameters at their defaults.")] = False,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE.urdf", help=TO_FILE)] = None,
) -> None:
    """Write a robot in another format, for simulators and other libraries."""
    from walkgen.emit.urdf import urdf as as_urdf
    from walkgen.pipeline import mechanism_of

    if not urdf:
        raise typer.BadParameter("name the format", param_hint="--urdf")
    deliver(as_urdf(mechanism_of(spec)).text, output)


@app.command()
def doctor() -> None:
    """Say what is installed and what is missing."""
    from walkgen.doctor import findings

    typer.echo(findings())


@app.command()
def explain(code: Annotated[str, typer.Argument(metavar="CODE", help="An error code, such as WG012.")]) -> None:
    """Explain an error code: cause, cure and an example."""
    from walkgen.explanations import explain as explanation

    typer.echo(explanation(code))


def _for_each(specs: list[Path], one: Callable[[Path], None]) -> None:
    """Do all specs even where one fails; every problem is raised together at the end."""
    problems = _problems(specs, one)
    if problems:
        raise WalkgenError(*problems)


def _problems(specs: list[Path], one: Callable[[Path], object]) -> tuple[Problem, ...]:
    found: list[Problem] = []
    for spec in specs:
        try:
            one(spec)
        except WalkgenError as error:
            found.extend(error.problems)
    return tuple(found)


if __name__ == "__main__":
    app()
