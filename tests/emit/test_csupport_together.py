"""All support headers in one source file, in double and in float, in either order: a robot may need any of them."""

import pytest
from csupport_library import CSUPPORT, STRICT, compile_c

_REAL = ("walkgen_real_f64.h", "walkgen_real_f32.h")
_HEADERS = sorted(path.name for path in CSUPPORT.glob("*.h") if path.name not in {*_REAL, "walkgen_loops.h"})


@pytest.mark.parametrize(("order", "standard", "compiler"), [(1, "-std=c99", "gcc"), (-1, "-std=c++11", "g++")])
def test_no_header_disturbs_another(tmp_path, order, standard, compiler):
    lines = [f'#include "{header}"\n' for real in _REAL for header in (real, *_HEADERS[::order])]
    assert compile_c(tmp_path, "".join(lines), "together.o", standard, "-O0", "-c", *STRICT, compiler=compiler).exists()
