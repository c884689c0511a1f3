"""A build killed at any moment leaves the old robot or the new one, whole, and no rubbish that grows."""

import multiprocessing
import os
import signal
import time
from pathlib import Path

import pytest
from small_robots import committed, text, tree, written

from walkgen import pipeline, processes
from walkgen.emit import landing
from walkgen.runtime import load

FORK = multiprocessing.get_context("fork")  # the imports are paid once; what is killed is the build itself
OLD, NEW = "0.35", "0.36"
FUNCTIONS = '["foot_position", "foot_jacobian", "inverse_velocity"]'
DELAYS = 12
TWO_DAYS = 2 * 86400


class Robots:
    """Two versions of a robot as they should look, and a folder in which one is built over the other."""

    def __init__(self, root: Path) -> None:
        self.out = root / "generated"
        self.specs = {thigh: written(root / f"{thigh}.toml", text(thigh, FUNCTIONS)) for thigh in (OLD, NEW)}
        self.whole = {thigh: committed(pipeline.build(self.specs[thigh], root / f"reference {thigh}").folder) for thigh in (OLD, NEW)}
        pipeline.build(self.specs[OLD], self.out)

    @property
    def version(self) -> str:
        """Which one stands there; none if it is neither."""
        now = committed(self.out / "robot")
        return next((thigh for thigh, whole in self.whole.items() if now == whole), "")

    @property
    def other(self) -> Path:
        return self.specs[NEW if self.version == OLD else OLD]

    def leftovers(self) -> list[Path]:
        return [path for path in self.out.iterdir() if path.name != "robot"]


@pytest.fixture(scope="module")
def robots(tmp_path_factory):
    return Robots(tmp_path_factory.mktemp("interruptions"))


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def dying_progress(step: int):
    """Kills its process at the step-th report."""
    reports = iter(range(step + 1))

    def progress(_: str) -> None:
        if next(reports) == step:
            die()

    return progress


def build_dying_at(spec: Path, out: Path, step: int) -> None:
    """In one process: what a second one takes of the functions, by chance none or some, is not reported."""
    processes._copies = lambda: False
    pipeline.build(spec, out, progress=dying_progress(step))


def build_dying_around(spec: Path, out: Path, name: str, when: str) -> None:
    """Kills its process before or after one of landing's functions."""
    inner = getattr(landing, name)

    def deadly(*arguments):
        if when == "before":
            die()
        inner(*arguments)
        die()

    setattr(landing, name, deadly)
    pipeline.build(spec, out)


def killed(target, *arguments) -> None:
    process = FORK.Process(target=target, args=arguments)
    process.start()
    process.join(60)
    assert process.exitcode == -signal.SIGKILL


@pytest.mark.parametrize("step", range(6))
def test_killed_at_every_step(robots, step):
    """read, three functions, compile, serialise: all before the new files take the old one's place."""
    before = robots.version
    killed(build_dying_at, robots.other, robots.out, step)
    assert robots.version == before != ""


@pytest.mark.parametrize(
    ("name", "when", "changes"), [("_fill", "after", False), ("_exchange", "before", False), ("_exchange", "after", True)]
)
def test_killed_around_the_exchange(robots, name, when, changes):
    before = robots.version
    killed(build_dying_around, robots.other, robots.out, name, when)
    assert robots.version != ""
    assert (robots.version != before) == changes


def test_killed_at_many_moments(robots):
    """Twelve delays spread over the build; each finds one version whole, and it loads."""
    start = time.perf_counter()
    pipeline.build(robots.other, robots.out)
    duration = time.perf_counter() - start
    killed_early = 0
    for index in range(DELAYS):
        process = FORK.Process(target=pipeline.build, args=(robots.other, robots.out))
        process.start()
        process.join(duration * (index + 0.5) / DELAYS)
        process.kill()
        process.join(60)
        killed_early += process.exitcode == -signal.SIGKILL
        assert robots.version != ""
        assert load(robots.out / "robot").legs["leg"].foot_position([0, 0, 0]).shape == (3,)
    assert killed_early >= 3  # a machine that becomes faster in between finishes some of them


def test_leftovers_are_removed_after_a_day(robots):
    killed(build_dying_around, robots.other, robots.out, "_exchange", "before")
    young, mine = robots.leftovers(), robots.out / ".walkgen-robot-notes"
    assert young
    mine.mkdir()
    pipeline.build(robots.other, robots.out)
    assert set(young) <= set(robots.leftovers())  # they may be another build's, still running
    for path in (*young, mine):
        os.utime(path, (time.time() - TWO_DAYS,) * 2)
    pipeline.build(robots.other, robots.out)
    assert robots.leftovers() == [mine]


def test_an_exception_leaves_no_trace(robots):
    before = tree(robots.out)

    def progress(step: str) -> None:
        if step == "serialise":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pipeline.build(robots.other, robots.out, progress=progress)
    assert tree(robots.out) == before


def test_two_builds_at_once(tmp_path):
    """From nothing, both into one folder: both succeed, and one of the two robots stands there."""
    specs = [written(tmp_path / f"{thigh}.toml", text(thigh, '["foot_position"]')) for thigh in (OLD, NEW)]
    processes = [FORK.Process(target=pipeline.build, args=(spec, tmp_path / "generated")) for spec in specs]
    for process in processes:
        process.start()
    for process in processes:
        process.join(60)
    assert [process.exitcode for process in processes] == [0, 0]
    assert sum(pipeline.stale(spec, tmp_path / "generated") == () for spec in specs) == 1
    assert [path.name for path in (tmp_path / "generated").iterdir()] == ["robot"]
