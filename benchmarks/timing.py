"""Cost of a call in processor time, both sides of a ratio taken in turns on one core."""

from __future__ import annotations

import contextlib
import os
import platform
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from typing import Any

LIBRARIES = (
    "spacerobot", "numpy", "scipy", "numba", "pin", "mujoco", "drake", "dask", "distributed", "pyarrow",
)  # fmt: skip

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True)
class Cost:
    """Of one call [s]: median, and quartiles, over the repeats."""

    median: float
    low: float
    high: float


def pin_to_one_core() -> int:
    """Keep this process on one core, the last that it may use; returns which."""
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


@contextlib.contextmanager
def all_cores() -> Iterator[int]:
    """Lift the pin for a measurement of several cores; gives how many there are."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, range(os.cpu_count() or 1))  # the kernel leaves out those that are not ours to use
    try:
        yield len(os.sched_getaffinity(0))
    finally:
        os.sched_setaffinity(0, before)


def on_cores(calls: Mapping[int, Callable[[], object]], *, repeats: int) -> list[dict[str, Any]]:
    """Wall time and this process's processor time of calls that use several cores, in turns, as rows for the results.

    A first round, which loads and compiles, is left out.

    Args:
        calls: cores that it may use -> what is measured.
        repeats: rounds.
    """
    taken: dict[int, list[tuple[float, float]]] = {cores: [] for cores in calls}
    for round_ in range(repeats + 1):
        for cores, call in calls.items():
            begun = time.monotonic(), time.process_time()
            call()
            if round_:
                taken[cores].append((time.monotonic() - begun[0], time.process_time() - begun[1]))
    rows = []
    for cores, pairs in taken.items():
        walls = [w for w, _ in pairs]
        rows.append(
            {
                "cores": cores,
                "wall": asdict(spread(walls)),
                "least_wall": min(walls),
                "processor": asdict(spread([p for _, p in pairs])),
            }
        )
    return rows


def costs(calls: Mapping[str, Callable[[], object]], *, repeats: int = 7, least: float = 0.05) -> dict[str, Cost]:
    """Processor time of each call [s].

    The machine may be busy with other things: processor time leaves them out, and taking the calls in turns lets
    whatever remains (cache, clock) meet all of them alike.

    Args:
        calls: name -> what is measured; single-threaded.
        repeats: rounds.
        least: processor time [s] of one measurement; short calls are repeated until it is reached.
    """
    counts = {}
    for name, call in calls.items():
        call()  # compiles, fills caches
        begun = time.process_time()
        call()
        once = max(time.process_time() - begun, 1e-7)
        counts[name] = max(1, round(least / once))
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repeats):
        for name, call in calls.items():
            begun = time.process_time()
            for _ in range(counts[name]):
                call()
            taken[name].append((time.process_time() - begun) / counts[name])
    return {name: spread(values) for name, values in taken.items()}


def spread(values: list[float]) -> Cost:
    """Median and quartiles."""
    if len(values) < 2:
        return Cost(values[0], values[0], values[0])
    low, _, high = statistics.quantiles(values, n=4, method="inclusive")
    return Cost(statistics.median(values), low, high)


def with_quartiles(found: Mapping[str, float], scale: float = 1.0, digits: str = ".3g") -> str:
    """A cost out of the results' file as the tables have it: median, and in brackets the quartiles where known."""
    median, low, high = (f"{scale * found.get(key, found['median']):{digits}}" for key in ("median", "low", "high"))
    return median if low == high == median else f"{median} ({low} to {high})"


def as_json(found: Mapping[str, Cost]) -> dict[str, dict[str, float]]:
    """For the results' file."""
    return {name: asdict(cost) for name, cost in found.items()}


def versions() -> dict[str, str]:
    """Of what takes part."""
    found = {"python": platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def processor() -> str:
    """Its name, as the machine tells it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            for line in stream:
                if line.startswith("model name"):
                    return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
