"""The hand-written C of dynamics_by_hand.c as a contestant."""

from peers.dynamics_source import HEAD, LEG, adapter
from peers.source import HERE, Peer, Source


def _sources() -> tuple[Source, ...]:
    text = (HERE / "dynamics_by_hand.c").read_text()
    return (Source("by hand", "closed", "\n".join([text, HEAD, adapter(LEG)])),)


PEER = Peer("by hand", _sources)
