"""Two tasks at a time give what they give one after the other."""

import os
import subprocess
import sys

import pytest

from walkgen.errors import Problem, SpecError
from walkgen.processes import both


def squared(number: int) -> tuple[int, int]:
    """And the process that found it."""
    return number * number, os.getpid()


def refused(code: str) -> None:
    """A task that fails."""
    raise SpecError(Problem(code, "no robot", "mend it"))


def grown(shared: dict[int, int]) -> int:
    """While another process reads it."""
    for key in range(400_000):
        shared.setdefault(key, key)
    return len(shared)


def in_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where the system does not copy processes."""
    monkeypatch.setattr("sys.platform", "elsewhere")


def test_both_results_come_back_in_order() -> None:
    (three, here), (four, there) = both(lambda: squared(3), squared, 4)
    assert (three, four, here) == (9, 16, os.getpid())
    alone = len(os.sched_getaffinity(0)) == 1
    assert (there == here) == alone


def test_one_process_serves_where_none_can_be_added(monkeypatch: pytest.MonkeyPatch) -> None:
    in_one_process(monkeypatch)
    assert both(lambda: squared(3), squared, 4) == ((9, os.getpid()), (16, os.getpid()))


@pytest.mark.parametrize("alone", [False, True])
def test_what_a_task_raises_arrives_whole(monkeypatch: pytest.MonkeyPatch, alone: bool) -> None:
    if alone:
        in_one_process(monkeypatch)
    with pytest.raises(SpecError) as second:
        both(lambda: squared(3), refused, "WG101")
    assert second.value.problems == (Problem("WG101", "no robot", "mend it"),)
    with pytest.raises(SpecError):
        both(lambda: refused("WG101"), squared, 4)


def test_the_first_task_may_change_what_both_are_given() -> None:
    shared = dict.fromkeys(range(200_000), 0)
    assert both(lambda: grown(shared), len, shared) == (400_000, 200_000)


def test_a_killed_process_leaves_none_behind() -> None:
    """The second process would hold the pipe open for a minute."""
    killed = "import os, signal, time; from walkgen.processes import both; "
    killed += "both(lambda: time.sleep(0.5) or os.kill(os.getpid(), signal.SIGKILL), time.sleep, 60)"
    done = subprocess.run([sys.executable, "-c", killed], stdout=subprocess.PIPE, timeout=30, check=False)
    assert done.returncode == -9
