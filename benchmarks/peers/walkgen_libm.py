"""walkgen's C of specs/mero_leg.toml with the C library's sine, cosine and arctangent, as every peer has them."""

from peers.source import Peer, Source
from peers.walkgen_c import built, unit

NAME = "walkgen, libm"


def _sources() -> tuple[Source, ...]:
    folder = built()
    return (Source(NAME, "spec", f"#define WALKGEN_LIBM\n{unit(folder)}", includes=(folder,)),)


PEER = Peer(NAME, _sources)
