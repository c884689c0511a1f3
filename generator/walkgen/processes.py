"""Two tasks at a time: the second in a process of its own, a copy of this one, where the system makes such copies."""

import ctypes
import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any, ParamSpec, TypeVar

First = TypeVar("First")
Second = TypeVar("Second")
Arguments = ParamSpec("Arguments")

_PR_SET_PDEATHSIG = 1
"""linux/prctl.h."""


def both(
    first: Callable[[], First], second: Callable[Arguments, Second], *arguments: Arguments.args, **named: Arguments.kwargs
) -> tuple[First, Second]:
    """What both tasks return; what either raises is raised here.

    Args:
        first: worked out here.
        second: worked out beside it; this function, its arguments and its result must be such as pickle knows.
        arguments: of the second task.
        named: of the second task too.
    """
    if not _copies():
        return first(), second(*arguments, **named)
    with ProcessPoolExecutor(1, multiprocessing.get_context("fork"), _ends_with_its_parent) as beside:
        other = beside.submit(_called, pickle.dumps((second, arguments, named)))  # whole before the first task touches what they share
        return first(), other.result()


def _called(task: bytes) -> Any:
    function, arguments, named = pickle.loads(task)  # noqa: S301 (written by this process)
    return function(*arguments, **named)


def _ends_with_its_parent() -> None:
    """A process that is killed leaves none behind."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _copies() -> bool:
    """Linux alone forks well; a daemonic process may have no children, and one processor serves no two processes."""
    return sys.platform == "linux" and len(os.sched_getaffinity(0)) > 1 and not multiprocessing.current_process().daemon
