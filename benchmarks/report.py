"""What every benchmark writes: where and with what it ran, as JSON beside the printed table."""

import datetime
import json
import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent / "results"


def machine() -> dict[str, Any]:
    """Processor, system and how busy it was."""
    text = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    models = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return {
        "processor": models[0] if models else platform.processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "libc": " ".join(platform.libc_ver()),
        "python": platform.python_version(),
        "load": [round(load, 2) for load in os.getloadavg()],
    }


def packages(names: Iterable[str]) -> dict[str, str]:
    """Versions of installed packages."""
    return {name: version(name) for name in names}


def write(name: str, content: Mapping[str, Any]) -> Path:
    """benchmarks/results/<name>.json with the date of the run and the machine."""
    RESULTS.mkdir(exist_ok=True)
    path = RESULTS / f"{name}.json"
    date = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
    path.write_text(json.dumps({"date": date, "machine": machine(), **content}, indent=1) + "\n")
    return path


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Columns as wide as their widest cell; names to the left, numbers to the right."""
    cells = [list(heads), *map(list, rows)]
    first, *others = (max(map(len, column)) for column in zip(*cells, strict=True))
    lines = ["  ".join([name.ljust(first), *map(str.rjust, numbers, others)]) for name, *numbers in cells]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])
