"""Equal bits on other processors: the own functions and a leg's code, run under emulators of aarch64 and of Cortex-M7 and M4.

Targets out of reach are left out: their closest points take the C library's hypot, cbrt and acos, and so its bits.
"""

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
from csupport_library import CSUPPORT
from trig_library import fma_flags

LEG = Path(__file__).parents[2] / "generated" / "mero_leg"
COMMON = ("-std=gnu99", "-O1", "-DWALKGEN_NO_BLOCKS", "-ffp-contract=off", "-fno-math-errno", f"-I{LEG}", f"-I{CSUPPORT}")

PROGRAM = """
#include "mero_leg.h"
#include "walkgen_real_f64.h"
#include "walkgen_real_f32.h"
#include <string.h>

static void say(const char *text);
static uint64_t seed = 20261129u, sum;

static int32_t whole(int32_t most) { /* -most .. most */
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (int32_t)((seed >> 33) % (2u * (uint32_t)most + 1u)) - most;
}
static void add(const void *data, size_t size) {
    const unsigned char *bytes = data;
    for (size_t at = 0; at < size; ++at) sum = (sum ^ bytes[at]) * 1099511628211u;
}
static void tell(const char *name) {
    char text[32], *next = text;
    while (*name) *next++ = *name++;
    *next++ = ' ';
    for (int digit = 15; digit >= 0; --digit) *next++ = "0123456789abcdef"[(sum >> (4 * digit)) & 15u];
    *next++ = '\\n', *next = 0;
    say(text);
    sum = 14695981039346656037u;
}
static void evaluate(void) {
    tell("start");
    {
        const volatile double small = -0x1.6481f1b11p-33; /* what compilers do not fold */
        const double found = small + 1.0;
        add(&found, sizeof found);
    }
    tell("sum64");
    for (int row = 0; row < 20000; ++row) { /* all scales up to 1e5, by exact arithmetic */
        const double x = (double)whole(100000000) / (double)(1 << (row % 27)) * 0.0009765625, y = (double)whole(1000000) + 0.5;
        if (x > 1e5 || x < -1e5) continue;
        const double found[3] = {wg_sin(x), wg_cos(x), wg_atan2(y, x)};
        add(found, sizeof found);
    }
    tell("trig64");
    for (int row = 0; row < 20000; ++row) {
        const float x = (float)whole(16000000) / (float)(1 << (row % 24)) * 0.0005f, y = (float)whole(100000) + 0.5f;
        const float found[3] = {wg_sin_f32(x), wg_cos_f32(x), wg_atan2_f32(y, x)};
        add(found, sizeof found);
    }
    tell("trig32");
    for (int part = 0; part < 2; ++part) {
        seed = 20261129u;
        for (int row = 0; row < 500; ++row) {
            double q[12], p[30];
            int32_t status[4];
            for (int at = 0; at < 12; ++at) q[at] = (double)whole(1 << 20) / (double)(1 << 19);
            mero_leg_leg_foot_position(q, p), mero_leg_leg_foot_hessian(q, p + 3);
            if (part == 0) {
                add(p, sizeof p);
                continue;
            }
            (void)mero_leg_leg_inverse(p, q, status), add(q, sizeof q), add(status, sizeof status);
            (void)mero_leg_leg_inverse_branch(p, row % 4, q), add(q, 3 * sizeof q[0]);
        }
        tell(part == 0 ? "forward" : "inverse");
    }
}
"""
HOSTED = "#include <stdio.h>\nstatic void say(const char *text) { fputs(text, stdout); }\nint main(void) { evaluate(); return 0; }\n"
BARE = """
/* Semihosting: the emulator prints and stops. */
static int32_t ask(int32_t what, const void *with) {
    register int32_t r0 __asm__("r0") = what;
    register const void *r1 __asm__("r1") = with;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}
static void say(const char *text) { (void)ask(4, text); }
__attribute__((noreturn)) void begin(void);
void begin(void) {
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* the floating-point unit */
    __asm__ volatile("dsb\\n\\tisb");
    seed = 20261129u, sum = 0; /* nobody has set variables */
    evaluate();
    for (;;) (void)ask(0x18, (const void *)0x20026);
}
__attribute__((section(".vectors"), used)) static const uintptr_t vectors[2] = {0x20010000u, (uintptr_t)begin};
"""
LAYOUT = """
ENTRY(begin)
SECTIONS {
    .text 0 : { KEEP(*(.vectors)) *(.text*) *(.rodata*) }
    .ARM.exidx : { *(.ARM.exidx*) }
    .data 0x20000000 : { *(.data*) }
    .bss : { *(.bss*) *(COMMON) end = .; }
}
"""


DOUBLE = ("trig64", "forward", "inverse")
"""Groups of functions in double; trig32 is in float, sum64 are sums of doubles."""


@dataclass(frozen=True)
class Target:
    """A compiler, its flags, and what runs its programs; whether double and float multiply and add with one rounding."""

    compiler: str
    flags: tuple[str, ...]
    emulator: tuple[str, ...]
    double: bool
    single: bool
    bare: bool = False


_M = ("-mthumb", "-mfloat-abi=hard")
_MPS2 = ("qemu-system-arm", "-nographic", "-semihosting", "-machine")
TARGETS = {
    "aarch64": Target("aarch64-linux-gnu-gcc", ("-static",), ("qemu-aarch64",), True, True),
    "aarch64, no fma": Target("aarch64-linux-gnu-gcc", ("-static", "-DWALKGEN_NO_FMA"), ("qemu-aarch64",), False, False),
    "M7": Target("arm-none-eabi-gcc", (*_M, "-mcpu=cortex-m7", "-mfpu=fpv5-d16"), (*_MPS2, "mps2-an500", "-kernel"), True, True, True),
    "M4": Target("arm-none-eabi-gcc", (*_M, "-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"), (*_MPS2, "mps2-an386", "-kernel"), False, True, True),
}


WRONG_SUMS = {"M4"}
"""Processors without doubles whose compilers' library may add them wrong in the last place: that of gcc 12 for Arm gives for
1 - 1.62e-10 a number 0.9 units away. Functions in double then have other bits there, those in float the same."""


def run(folder: Path, target: Target) -> dict[str, str]:
    """What the program says: a digest of all bits for each group of functions."""
    (folder / "bits.c").write_text(PROGRAM + (BARE if target.bare else HOSTED))
    (folder / "layout.ld").write_text(LAYOUT)
    linked = ("-nostartfiles", "--specs=nosys.specs", "-T", "layout.ld", "-Wl,--no-warn-rwx-segments") if target.bare else ()
    sources = ("bits.c", str(LEG / "mero_leg.c"))
    command = (target.compiler, *COMMON, *target.flags, *linked, *sources, "-o", "bits", "-lm")
    compiled = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert compiled.returncode == 0, compiled.stderr
    said = subprocess.run((*target.emulator, str(folder / "bits")), capture_output=True, text=True, timeout=120, check=False)
    lines = dict(line.split() for line in (said.stdout + said.stderr).splitlines() if len(line.split()) == 2)
    assert set(lines) == {"start", "sum64", *DOUBLE, "trig32"}, said
    return lines


@pytest.fixture(scope="module")
def here(tmp_path_factory):
    """This processor's bits with one rounding and with two."""
    if not fma_flags():
        pytest.skip("this processor has no fused multiply-add that a flag chooses")
    folder = tmp_path_factory.mktemp("here")
    return {
        fused: run(folder, Target("gcc", flags, (), fused, fused)) for fused, flags in ((True, fma_flags()), (False, ("-DWALKGEN_NO_FMA",)))
    }


def test_the_two_classes_differ(here):
    assert all(here[True][group] != here[False][group] for group in (*DOUBLE, "trig32"))


@pytest.mark.parametrize("name", TARGETS)
def test_the_same_bits_there(here, tmp_path, name):
    target = TARGETS[name]
    missing = [tool for tool in (target.compiler, target.emulator[0]) if shutil.which(tool) is None]
    if missing:
        pytest.skip(f"{' and '.join(missing)} missing; in Debian gcc-aarch64-linux-gnu, gcc-arm-none-eabi, qemu-user, qemu-system-arm")
    found = run(tmp_path, target)
    assert found["trig32"] == here[target.single]["trig32"]
    if found["sum64"] != here[False]["sum64"]:
        assert name in WRONG_SUMS
        return
    assert [found[group] for group in DOUBLE] == [here[target.double][group] for group in DOUBLE]
