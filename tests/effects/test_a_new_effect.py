"""A file with an effect is enough: whatever the tests ask of every effect, a new one passes without another entry."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from spacerobot.effects import catalogue

ROOT = Path(__file__).resolve().parents[2]
NAME = "newcomer"

REGISTRY_WIDE = sorted(
    str(path.relative_to(ROOT))
    for path in (ROOT / "tests").rglob("test_*.py")
    if re.search(r"all_effects\(\)(?!\[)", path.read_text(encoding="utf-8")) and path != Path(__file__)
)
"""Test files that ask something of the whole catalogue."""

WHOLE = "catalogue promised effect_has every_edit full_batch every_parameter all_starts any_two"
CHOSEN = " or ".join([NAME, *WHOLE.split()])
"""The newcomer's own cases, and tests that go through the catalogue in one."""


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """A folder with a copy of viscous friction under another name, found as an installed package's effects are."""
    text = (Path(catalogue.__path__[0]) / "viscous_friction.py").read_text(encoding="utf-8")
    assert text.count('"viscous_friction"') == 1
    (tmp_path / f"{NAME}.py").write_text(text.replace('"viscous_friction"', f'"{NAME}"'))
    about = tmp_path / f"{NAME}-1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {NAME}\nVersion: 1\n")
    (about / "entry_points.txt").write_text(f"[spacerobot.effects]\n{NAME} = {NAME}\n")
    return tmp_path


@pytest.mark.slow
def test_a_copied_effect_passes_every_test_of_the_catalogue(installed: Path) -> None:
    path = os.pathsep.join(filter(None, (str(installed), str(ROOT), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "no:cacheprovider",
            "-m",
            "not slow",
            *REGISTRY_WIDE,
            "-k",
            CHOSEN,
        ],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=3000,
    )
    assert len(REGISTRY_WIDE) > 6
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-1000:]
    listed = subprocess.run(
        [sys.executable, "-m", "spacerobot", "prove", "--list"],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert NAME in listed.partition("not yet proved:")[2].split()


def test_the_lists_are_the_catalogue() -> None:
    from spacerobot.effects.registry import all_effects
    from spacerobot.proof.proved import not_yet_proved, proved

    assert set(proved()) | set(not_yet_proved()) == set(all_effects())
    assert not set(proved()) & set(not_yet_proved())
    assert "wrist" in proved()["coulomb_friction"]
