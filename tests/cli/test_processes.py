"""Tasks that two processes share give what they give one after the other."""

import os
import subprocess
import sys
import time
from functools import partial

import pytest

from walkgen.errors import Problem, SpecError
from walkgen.processes import shared_out


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


def slowly(number: int) -> tuple[int, int]:
    """As one that leaves the others to the second process."""
    time.sleep(0.5)
    return squared(number)


def test_results_come_back_in_order_from_both_processes() -> None:
    found = shared_out([partial(slowly, 0), *(partial(squared, number) for number in range(1, 9))])
    assert [result for result, _ in found] == [number * number for number in range(9)]
    alone = len(os.sched_getaffinity(0)) == 1
    assert len({process for _, process in found}) == (1 if alone else 2)


def test_one_process_serves_where_none_can_be_added(monkeypatch: pytest.MonkeyPatch) -> None:
    in_one_process(monkeypatch)
    assert shared_out([partial(squared, 3), partial(squared, 4)]) == ((9, os.getpid()), (16, os.getpid()))


@pytest.mark.parametrize("alone", [False, True])
@pytest.mark.parametrize("first", [slowly, squared])
@pytest.mark.parametrize("place", [0, 1])
def test_what_a_task_raises_arrives_whole(monkeypatch: pytest.MonkeyPatch, alone: bool, first: object, place: int) -> None:
    if alone:
        in_one_process(monkeypatch)
    tasks = [partial(first, 3), partial(slowly, 4)]
    tasks.insert(place, partial(refused, "WG101"))
    with pytest.raises(SpecError) as failed:
        shared_out(tasks)
    assert failed.value.problems == (Problem("WG101", "no robot", "mend it"),)


def test_after_a_failure_no_task_is_begun(tmp_path) -> None:
    def marked(number: int) -> None:
        time.sleep(0.2)
        (tmp_path / str(number)).touch()

    with pytest.raises(SpecError):
        shared_out([partial(refused, "WG101"), *(partial(marked, number) for number in range(9))])
    assert len(list(tmp_path.iterdir())) <= 1


def test_a_task_may_change_what_others_are_given() -> None:
    shared = dict.fromkeys(range(200_000), 0)
    first, second = shared_out([partial(grown, shared), partial(len, shared)])
    assert first == 400_000
    assert second in (200_000, 400_000)


def test_a_killed_process_leaves_none_behind() -> None:
    """The second process would hold the pipe open for a minute."""
    killed = "import os, signal, time; from functools import partial; from walkgen.processes import shared_out; "
    killed += "shared_out([lambda: time.sleep(0.5) or os.kill(os.getpid(), signal.SIGKILL), partial(time.sleep, 60)])"
    done = subprocess.run([sys.executable, "-c", killed], stdout=subprocess.PIPE, timeout=30, check=False)
    assert done.returncode == -9
