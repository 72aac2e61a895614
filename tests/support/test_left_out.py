"""What a test run leaves out for want of a library is told, with the command that runs it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from tests.conftest import COMMAND, WANTS, left_out, wanted

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", sorted({name for names in WANTS.values() for name in names}))
def test_a_missing_library_is_one_of_its_extra(name: str) -> None:
    with pytest.raises(pytest.skip.Exception) as skipped:
        pytest.importorskip(f"{name}.of_nobody", exc_type=ImportError)
    assert name in WANTS[str(wanted(str(skipped.value)))]


def test_the_line_counts_by_extra_and_says_nothing_else() -> None:
    reasons = ["could not import 'pyarrow': No module named 'pyarrow'", "extra 'scale' is not installed", "root may"]
    assert re.search(r": 2 for `scale`; ", left_out(reasons))
    assert COMMAND in left_out(reasons)
    assert left_out(["root may write everywhere", "no site: `make docs` builds it"]) == ""


def test_every_skip_of_the_suite_names_a_library_that_the_line_knows() -> None:
    """A library that a test can do without, and that the test extra does not bring, is of an extra."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    brought = " ".join([*project["dependencies"], *project["optional-dependencies"]["test"], "scipy"])
    for path in (ROOT / "tests").rglob("*.py"):
        for name in re.findall(r'importorskip\("([\w.]+)"', path.read_text(encoding="utf-8")):
            assert wanted(f"could not import '{name}'") or name.partition(".")[0] in brought, (path, name)


def test_the_command_installs_all_of_them() -> None:
    target = COMMAND.split()[1]
    recipe = (ROOT / "Makefile").read_text(encoding="utf-8").partition(f"\n{target}:")[2].partition("\n\n")[0]
    for extra in WANTS:
        assert extra in recipe
