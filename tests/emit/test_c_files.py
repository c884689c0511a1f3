"""Whole generated C files: strict compilers, batches, composites, linking, strangers' words, size, sanitizers, CMake."""

import shutil
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import pytest
from c_bench import (
    CPLUSPLUS,
    STRICT,
    WARNINGS,
    Builder,
    code,
    compile_object,
    defined,
    execute,
    mechanism,
    needs_gcc,
    needs_gplusplus,
    run,
    undefined,
    write,
)
from test_walker import long_program

from walkgen.emit.c_files import build_files, c_sources
from walkgen.emit.c_function import composite_function, kernel
from walkgen.emit.c_printer import DOUBLE, CPrinter
from walkgen.emit.c_text import comment, comment_text
from walkgen.graph.program import Call, Code, Composite, Program
from walkgen.signature import Port, Signature

PRINTER = CPrinter(DOUBLE, fma=True)
HOSTILE = 'ends */ int evil; /* opens ??/ splices \\\nnext line ??( "quoted" %s é 日本 \u202e \x00 $HOME `id` // slashes */*/ ?????/'


def position(robot: str = "bot") -> Program:
    b = Builder(Port("q", (2,), "rad"), Port("unused", (3,)))
    x = b.add(Code.ADD, b.add(Code.COS, 0), b.add(Code.COS, 1), name="reach")
    y = b.add(Code.ADD, b.add(Code.SIN, 0), b.add(Code.SIN, 1))
    return b.program("foot_position", [Port("p", (2,), "m")], [x, y], robot=robot, doc="Foot position.")


def root() -> Program:
    """A scalar in, a scalar out, and a scalar status: 2 for a negative number."""
    b = Builder(Port("x"), Port("sign", kind="integer"), Port("param", (1,)))
    value = b.add(Code.MUL, b.add(Code.SQRT, 0), b.add(Code.MUL, 1, 2))
    status = b.add(Code.SELECT, b.add(Code.LESS_EQUAL, b.constant("0"), 0), b.constant("0"), b.constant("2"))
    return b.program("root", [Port("y"), Port("status", kind="integer")], [value, status])


def roots() -> Program:
    """Both square roots with a status each."""
    b = Builder(Port("x"))
    plus = b.add(Code.SQRT, 0)
    good = b.add(Code.LESS_EQUAL, b.constant("0"), 0)
    status = b.add(Code.SELECT, good, b.constant("0"), b.constant("2"))
    return b.program("roots", [Port("y", (2,)), Port("status", (2,), kind="integer")], [plus, b.add(Code.NEG, plus), status, status])


MAIN = """
#include <stdio.h>
#include "bot.h"
#include "bot_f32.h"
int main(void) {
    const double x[3] = {4.0, -1.0, 9.0}, param[1] = {10.0};
    const float xf[3] = {4.0f, -1.0f, 9.0f}, paramf[1] = {10.0f};
    const int32_t sign[3] = {1, 1, -1};
    double y[3], both[6];
    float yf[3];
    int32_t status[3], statuses[6];
    size_t bad = bot_leg_root_batch(3, x, sign, param, y, status);
    printf("%d %g %g %d %d %d\\n", (int)bad, y[0], y[2], (int)status[0], (int)status[1], (int)status[2]);
    bad = bot_f32_leg_root_batch(3, xf, sign, paramf, yf, status);
    printf("%d %g %g\\n", (int)bad, (double)yf[0], (double)yf[2]);
    printf("%d %d\\n", (int)bot_leg_roots(9.0, both, statuses), (int)bot_leg_roots(-1.0, both, statuses));
    bad = bot_leg_roots_batch(3, x, both, statuses);
    printf("%d %g %g\\n", (int)bad, both[0], both[5]);
    printf("%s %s\\n", walkgen_status_text(2), walkgen_status_text(99));
    return 0;
}
"""


@needs_gcc
@pytest.mark.parametrize("sanitize", [(), ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")])
def test_scalars_statuses_and_batches(tmp_path, sanitize):
    write(tmp_path, code(position(), root(), roots()))
    lines = execute(tmp_path, MAIN, ["bot.c", "bot_f32.c"], *STRICT, *sanitize)
    assert lines == ["1 20 -30 0 2 0", "1 20 -30", "2 0", "1 2 -3", "BAD_INPUT UNKNOWN"]


@needs_gcc
def test_compiles_under_strict_flags_at_every_level(tmp_path):
    write(tmp_path, code(position(), root(), roots()))
    for level in ("-O0", "-O3", "-Os"):
        for source in ("bot.c", "bot_f32.c"):
            compile_object(tmp_path / source, "-std=c99", *WARNINGS.split(), level)


@needs_gplusplus
def test_headers_and_sources_are_cplusplus_too(tmp_path):
    write(tmp_path, code(position(), root(), roots()))
    for source in ("bot.c", "bot_f32.c"):
        compile_object(tmp_path / source, *CPLUSPLUS, compiler="g++")
        assert all(not name.startswith("_Z") for name in defined(tmp_path / "bot.o"))


@needs_gcc
def test_two_robots_link_into_one_program(tmp_path):
    for robot in ("bot", "other"):
        write(tmp_path, code(position(robot), robot=mechanism(robot)))
        for source in (f"{robot}.c", f"{robot}_f32.c"):
            path = compile_object(tmp_path / source, *STRICT)
            assert defined(path)
            assert all(name.startswith(f"{robot}_") for name in defined(path))
            assert undefined(path) <= {"sincos", "sincosf", "sin", "cos", "sinf", "cosf", "_GLOBAL_OFFSET_TABLE_"}
    main = """
#include <stdio.h>
#include "bot.h"
#include "other.h"
int main(void) {
    const double q[2] = {0.0, 0.0}, unused[3] = {0.0, 0.0, 0.0};
    double p[2], r[2];
    bot_leg_foot_position(q, unused, p);
    other_leg_foot_position(q, unused, r);
    printf("%g %g %d\\n", p[0], r[0], BOT_LEG_JOINTS + OTHER_NQ);
    return 0;
}
"""
    assert execute(tmp_path, main, ["bot.c", "bot_f32.c", "other.c", "other_f32.c"]) == ["2 2 4"]


def test_one_unit_may_hold_both_precisions(tmp_path):
    write(tmp_path, code(position(), root()))
    (tmp_path / "all.c").write_text('#include "bot.c"\n#include "bot_f32.c"\n')
    compile_object(tmp_path / "all.c", *STRICT)


def counted_root() -> Composite:
    """The kernel `root` twice, the second time only where the first failed; a local array between two kernels."""
    kernel_program = root()
    signature = Signature("bot", "leg", "safe_root", kernel_program.signature.inputs, kernel_program.signature.outputs, "Safe root.")
    b = Builder(Port("x"))
    squares = b.program("square", [Port("squares", (2,))], [b.add(Code.MUL, 0, 0), 0])
    pick = Builder(Port("squares", (2,)), Port("sign", kind="integer"), Port("param", (1,)))
    last = pick.program("pick", [Port("y")], [pick.add(Code.MUL, 0, 3)])
    return Composite(
        signature,
        (Port("squares", (2,)),),
        (
            Call(kernel_program, ("x", "sign", "param", "y", "status")),
            Call(squares, ("x", "squares"), ("wg_any_unreachable", ("status", 1))),
            Call(last, ("squares", "sign", "param", "y"), ("wg_any_unreachable", ("status", 1))),
        ),
        ("walkgen_inverse.h",),
    )


@needs_gcc
def test_composite_runs_its_steps_under_their_guards(tmp_path):
    composite = counted_root()
    program = composite.calls[0].callee
    assert isinstance(program, Program)
    second = Composite(Signature("bot", "leg", "again", program.signature.inputs, program.signature.outputs), (), composite.calls[:1], ())
    write(tmp_path, code(composite, second))
    text = (tmp_path / "bot.c").read_text()
    assert text.count("WG_STATIC_ROW(void bot_leg_root_kernel)(") == 1
    assert text.count("if (status == WALKGEN_UNREACHABLE) {\n        bot_leg_safe_root_rest(") == 1
    assert text.count("WG_CALLED void bot_leg_safe_root_rest(") == 1
    assert "double squares[2];" in text.split("bot_leg_safe_root_rest(")[1].split("}")[0]
    assert "if (status == WALKGEN_UNREACHABLE) {" in (tmp_path / "bot_f32.c").read_text()
    main = """
#include <stdio.h>
#include "bot.h"
int main(void) {
    const double param[1] = {10.0};
    double y;
    int32_t status = bot_leg_safe_root(4.0, 1, param, &y);
    printf("%d %g\\n", (int)status, y);
    return 0;
}
"""
    assert execute(tmp_path, main, ["bot.c", "bot_f32.c"]) == ["0 20"]


_SAFE = """
#include <stdio.h>
#include <string.h>
#include "bot.h"
int main(void) {
    const double x[6] = {4.0, -1.0, 9.0, 16.0, 25.0, 36.0}, param[1] = {10.0};
    const int32_t sign[6] = {1, 1, -1, 1, 1, 1};
    double y, left[6], right[6];
    int32_t found[6], status = bot_right_safe_root(9.0, -1, param, &y);
    const size_t bad = bot_left_safe_root_batch(6, x, sign, param, left, found);
    printf("%d %g\\n", (int)status, y);
    printf("%d ", (int)(bad == bot_right_safe_root_batch(6, x, sign, param, right, found)));
    printf("%d\\n", memcmp(left, right, sizeof left));
    return 0;
}
"""


@needs_gcc
def test_what_equal_legs_do_in_steps_stands_once(tmp_path):
    steps = counted_root()
    legs = (replace(steps, signature=replace(steps.signature, owner=owner)) for owner in ("left", "right"))
    write(tmp_path, code(*legs))
    text = (tmp_path / "bot.c").read_text()
    assert text.count("    return bot_left_safe_root(x, sign, param, y);") == 1
    assert text.count("    return bot_left_safe_root_batch(rows, x, sign, param, y, status);") == 1
    assert "bot_right_safe_root_rest" not in text
    assert execute(tmp_path, _SAFE, ["bot.c"], *STRICT) == ["0 -30", "1 0"]


def test_composite_names_values_literals_and_addresses():
    inner = root()
    arguments = (Decimal("0.25"), 3, "param", "y", "status")
    signature = Signature("bot", "leg", "quarter", (Port("param", (1,)),), inner.signature.outputs)
    composite = Composite(signature, (), (Call(inner, arguments),), ())
    function = composite_function(composite, {inner: kernel(inner, "inner", PRINTER)}, PRINTER)
    assert function.lines == ("    int32_t status = WALKGEN_OK;", "    inner(0.25, 3, param, y, &status);", "    return status;")


def test_comments_cannot_be_left():
    text = comment_text(HOSTILE)
    assert text.isascii()
    assert all(danger not in text for danger in ("*/", "/*", "//*", "\\", "??", "\n"))


def test_comments_stay_closed_when_wrapped():
    block = "\n".join(comment("*" * 300 + "/" * 300, "/*" * 300, HOSTILE * 5))
    assert block.count("*/") == 1
    assert block.count("/*") == 1
    assert "\\" not in block


@needs_gcc
def test_strangers_words_never_reach_the_compiler(tmp_path):
    robot = mechanism(description=HOSTILE, source_name=HOSTILE)
    program = position()
    signature = Signature("bot", "leg", "foot_position", program.signature.inputs, program.signature.outputs, HOSTILE, HOSTILE)
    hostile = code(Program(signature, program.ops, program.outputs), robot=robot)
    write(tmp_path, hostile)
    compile_object(tmp_path / "bot.c", *STRICT)
    for artifact in (*c_sources(hostile), *build_files(hostile)):
        assert artifact.text.isascii(), artifact.path
        assert "int evil" not in [line.strip() for line in artifact.text.splitlines()]


@needs_gcc
def test_ten_thousand_operations_compile(tmp_path):
    write(tmp_path, code(long_program(10_000), float32=False))
    compile_object(tmp_path / "bot.c", *STRICT)


def test_bytes_do_not_depend_on_the_run():
    bodies = (position(), root(), counted_root())
    first, second = (c_sources(code(*bodies)) for _ in range(2))
    assert first == second


def test_every_function_is_documented_with_units_and_cost():
    header = next(artifact.text for artifact in c_sources(code(position())) if str(artifact.path) == "bot.h")
    assert "/* Foot position.\n * q [2] rad, unused [3] -> p [2] m\n * 6 operations (at most 40 bytes of locals)." in header
    assert "#define BOT_LEG_HIP_MIN (-1.0) /* rad */" in header
    assert '#define BOT_DIGEST "' in header


@needs_gcc
@pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")
def test_cmake_installs_a_package_that_is_found(tmp_path):
    robot = code(position(), float32=False)
    source = tmp_path / "bot"
    write(source, robot)
    for artifact in build_files(robot):
        (source / artifact.path).write_text(artifact.text)
    (source / "bot_test.c").write_text("int main(void) { return 0; }\n")
    prefix = tmp_path / "prefix"
    run("cmake", "-S", source, "-B", tmp_path / "build", f"-DCMAKE_INSTALL_PREFIX={prefix}")
    run("cmake", "--build", tmp_path / "build", "--target", "install")
    app = tmp_path / "app"
    app.mkdir()
    (app / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.15)\nproject(app C)\nfind_package(bot 0.1 REQUIRED)\n"
        "add_executable(app main.c)\ntarget_link_libraries(app PRIVATE bot::bot)\n"
    )
    (app / "main.c").write_text('#include "bot.h"\nint main(void) { return BOT_NQ - 2; }\n')
    run("cmake", "-S", app, "-B", app / "build", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", app / "build")
    run(app / "build" / "app")
    assert (prefix / "lib" / "pkgconfig" / "bot.pc").exists() or list(Path(prefix).glob("lib*/**/bot.pc"))
