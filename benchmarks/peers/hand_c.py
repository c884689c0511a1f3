"""The hand-written C of by_hand.c as a contestant."""

from peers.source import HERE, Peer, Source


def _sources() -> tuple[Source, ...]:
    return (Source("by hand", "closed", (HERE.parent / "by_hand.c").read_text()),)


PEER = Peer("by hand", _sources)
