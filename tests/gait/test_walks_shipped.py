"""The shipped specs walk: MERO on the level and up 15 degrees, the quadruped with both of its bodies, Garrec's robot by its cranks, the
biped on its soles.
"""

from pathlib import Path

import pytest

from walkgen.walking import walked
from walkgen.walking_request import Wanted

SPECS = Path(__file__).parents[2] / "specs"
pytestmark = pytest.mark.nightly
WALKS = [
    *(("mero", Wanted(gait=gait, terrain=ground)) for gait in ("tripod", "wave", "slow_wave") for ground in ("flat", "slope:15")),
    ("mero", Wanted(gait="tripod", terrain="0.03*sin(2*x)*cos(y)", adapt=True, from_rest=True)),
    ("quadruped", Wanted(gait="waved")),
    ("quadruped", Wanted(gait="swinging")),
    ("quadruped", Wanted(gait="set_right")),
    ("garrec", Wanted(give=0.002)),
    ("anthropomorphic_biped", Wanted()),
    *(("anthropomorphic_biped", Wanted(terrain=f"slope:{degrees}")) for degrees in (8, -6)),
    ("anthropomorphic_biped", Wanted(from_rest=True, cycles=4, heading=20.0)),
]


@pytest.fixture(scope="module", autouse=True)
def _own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("walks")))
        yield


@pytest.mark.parametrize(("name", "wanted"), WALKS, ids=lambda value: value if isinstance(value, str) else value.gait + value.terrain)
def test_it_walks(name, wanted):
    walk = walked(SPECS / f"{name}.toml", wanted).walk
    assert walk.feasible, "\n".join(map(str, walk.faults))
    assert walk.least_margin > (0.2 if name == "mero" else 0.01)
    assert walk.slip < (wanted.give or 1e-12)
    assert walk.energy["positive"] > 0.0
