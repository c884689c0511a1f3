"""Tasks shared out among two processes: the second is a copy of this one, where the system makes such copies."""

import ctypes
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

Result = TypeVar("Result")

_PR_SET_PDEATHSIG = 1
"""linux/prctl.h."""


def shared_out(tasks: Sequence[Callable[[], Result]]) -> tuple[Result, ...]:
    """What the tasks return, in their order; what one raises is raised here.

    Each process takes the next task when it has done one: long ones had better come first.

    Args:
        tasks: what they return must be such as pickle knows. A task sees what it shares with others as it is now, or as they left it.
    """
    if len(tasks) < 2 or not _copies():
        return tuple(task() for task in tasks)
    context = multiprocessing.get_context("fork")
    work = _Work(tasks, context.Value("i", 0))
    with ProcessPoolExecutor(1, context, _begin, (work,)) as beside:
        other = beside.submit(_rest)
        found = work.done()
        found.update(other.result())
    return tuple(found[number] for number in range(len(tasks)))


@dataclass(frozen=True)
class _Work(Generic[Result]):
    """Tasks, and how many are taken; `copied` is what a process was made with."""

    tasks: Sequence[Callable[[], Result]]
    taken: Any
    copied: ClassVar["_Work[Any]"]

    def done(self) -> dict[int, Result]:
        """What this process does of them, by their numbers; none is taken any more once one has failed."""
        try:
            return {number: self.tasks[number]() for number in self._numbers()}
        except BaseException:
            self.taken.value = len(self.tasks)
            raise

    def _numbers(self) -> Iterator[int]:
        while (number := self._next()) < len(self.tasks):
            yield number

    def _next(self) -> int:
        with self.taken.get_lock():
            self.taken.value += 1
            return int(self.taken.value) - 1


def _begin(work: "_Work[Any]") -> None:
    _ends_with_its_parent()
    _Work.copied = work


def _rest() -> dict[int, Any]:
    return _Work.copied.done()


def _ends_with_its_parent() -> None:
    """A process that is killed leaves none behind."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _copies() -> bool:
    """Linux alone forks well; a daemonic process may have no children, and one processor serves no two processes."""
    return sys.platform == "linux" and len(os.sched_getaffinity(0)) > 1 and not multiprocessing.current_process().daemon
