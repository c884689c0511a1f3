"""Times contestants that are called from Python: the cost of an empty call with the same arguments is taken off."""

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from leg import TOLERANCE, Array, Inputs, LegFunction, error, expected
from peers.source import Caller

_ROWS = 256


def check(caller: Caller, function: LegFunction, inputs: Inputs) -> str:
    """Empty when the answers agree with the reference; else what differs."""
    right = expected(function, inputs)
    rows = zip(inputs.rows(function)[:_ROWS], inputs.branch[:_ROWS].tolist(), strict=True)
    found = {"row": error(function, np.array([_flat(caller.row(x, branch), function, 1)[0] for x, branch in rows]), right[:_ROWS])}
    if caller.batch is not None:
        found["batch"] = error(function, _flat(caller.batch(inputs.rows(function), inputs.branch), function, len(right)), right)
    return ", ".join(f"{kind} is off by {value:.3g}" for kind, value in found.items() if not value <= TOLERANCE)


def _flat(answer: Any, function: LegFunction, rows: int) -> Array:
    """Whatever shape a caller answers in, as [rows, size]; statuses are dropped."""
    if isinstance(answer, list):
        return np.stack(np.broadcast_arrays(*answer, np.zeros(rows))[:-1], axis=-1).reshape(rows, -1)
    parts = answer if isinstance(answer, tuple) else (answer,)
    return np.hstack([np.asarray(part).reshape(rows, -1) for part in parts])[:, : function.size]


def _empty(_: Any, __: int) -> None:
    return None


def _loop(call: Callable[..., Any], rows: Sequence[tuple[Any, int]]) -> float:
    start = time.thread_time_ns()
    for x, branch in rows:
        call(x, branch)
    return (time.thread_time_ns() - start) / len(rows)


def _once(call: Callable[..., Any], inputs: Inputs, function: LegFunction) -> float:
    rows = inputs.rows(function)
    start = time.thread_time_ns()
    call(rows, inputs.branch)
    return (time.thread_time_ns() - start) / len(rows)


def race(callers: Sequence[Caller], function: LegFunction, few: Inputs, many: Inputs, repetitions: int) -> list[dict[str, float]]:
    """Median ns of a call and of a row of a batch, in the callers' order; each repetition takes the next rows and starts elsewhere."""
    calls: list[list[float]] = [[] for _ in callers]
    batches: list[list[float]] = [[] for _ in callers]
    pairs = list(zip(few.rows(function), few.branch.tolist(), strict=True))
    for repetition in range(repetitions):
        start = repetition * _ROWS % len(pairs)
        rows = pairs[start : start + _ROWS]
        for index in np.roll(np.arange(len(callers)), -repetition):
            caller = callers[index]
            calls[index].append(_loop(caller.row, rows) - _loop(_empty, rows))
            if caller.batch is not None:
                batches[index].append(_once(caller.batch, many, function))
    return [_medians(*times) for times in zip(calls, batches, strict=True)]


def _medians(calls: list[float], batches: list[float]) -> dict[str, float]:
    found = {"throughput": statistics.median(calls)}
    return found | ({"batch": statistics.median(batches)} if batches else {})
