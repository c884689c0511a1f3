"""The hand-written inverse of by_hand.c on walkgen's arctangent: what walkgen's gain owes to that, and what to the rest."""

from hashlib import sha256

from peers.source import HERE, Peer, Source
from peers.walkgen_c import built

_HEAD = '#include <math.h>\n#include "walkgen_real_f64.h"\n#define atan2 wg_atan2\n'


def _sources() -> tuple[Source, ...]:
    folder = built()
    used = "".join((folder / name).read_text() for name in ("walkgen_math.h", "walkgen_trig.h"))
    text = f"/* {sha256(used.encode()).hexdigest()} */\n{_HEAD}{(HERE.parent / 'by_hand.c').read_text()}"
    return (Source("by hand, walkgen's atan2", "closed", text, includes=(folder,)),)


PEER = Peer("by hand, walkgen's atan2", _sources)
