"""For every test: the same examples in every run, what is long in one piece first, and one line at the end of what was
skipped for want of a library."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import settings

from spacerobot.support.workers import one_thread

settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")  # a run beside a busy core is a run like any other

COMMAND = "make test-extras"

WANTS = {
    "scale": ("pyarrow", "distributed"),
    "tables": ("pandas", "xarray"),
    "proof": ("mujoco", "pysindy"),
    "browser": ("playwright",),
    "notebooks": ("nbclient", "nbformat", "ipykernel", "ipywidgets"),
}
"""Extra of pyproject.toml -> its libraries that tests can do without."""


FIRST = ("test_readme.py",)
"""Files that begin with a minute's work in one piece: at the end all other workers would wait for it."""


@pytest.fixture(scope="session", autouse=True)
def _one_thread_of_linear_algebra() -> Iterator[None]:
    """As commands have it: threads of several workers wait for each other, up to ten times as long as they work."""
    with one_thread():
        yield


def pytest_collection_modifyitems(items: list[Any]) -> None:
    """Those first, all others in their order."""
    items.sort(key=lambda item: item.path.name not in FIRST)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """The one line."""
    line = left_out([str(report.longrepr) for report in terminalreporter.stats.get("skipped", [])])
    if line:
        terminalreporter.write_line(line)


def left_out(reasons: list[str]) -> str:
    """How many tests (or whole files of them) were skipped for want of which extra, and the command that runs them."""
    count = Counter(extra for reason in reasons if (extra := wanted(reason)))
    if not count:
        return ""
    extras = ", ".join(f"{number} for `{extra}`" for extra, number in sorted(count.items()))
    return f"skipped for want of libraries, tests or whole files: {extras}; `{COMMAND}` installs them and runs all"


def wanted(reason: str) -> str | None:
    """The extra that a skipped test needed, None where it was skipped for something else."""
    for extra, libraries in WANTS.items():
        if re.search(rf"extra [`']{extra}[`'] is not installed", reason):
            return extra
        if any(re.search(rf"import '{name}[.']|{name} is not installed", reason) for name in libraries):
            return extra
    return None
