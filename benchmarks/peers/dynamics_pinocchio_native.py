"""Pinocchio's algorithms compiled from its headers for this processor: 0 to 18 % faster than its library, minutes and 3 GB to compile."""

from compiling import COMMON
from peers.dynamics_pinocchio import sources
from peers.pinocchio_cpp import LINK
from peers.source import Peer

PEER = Peer("Pinocchio", lambda: tuple(sources("its headers", LINK, (*COMMON, "-O3", "-march=native"))), "pin")
