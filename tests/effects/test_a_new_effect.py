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

REGISTRY_WIDE = (
    "tests/effects/test_registry.py",
    "tests/simulation/test_effects_at_null.py",
    "tests/diagnosis/models/test_sizes.py",
    "tests/diagnosis/test_full_size.py",
    "tests/proof/test_batch.py",
    "tests/proof/test_rig_engine.py",
    "tests/view/test_docs_parts.py",
    "tests/view/test_report_words.py",
)
"""Test files that ask something of the whole catalogue; a test below holds that none is forgotten."""

CHOSEN = f"{NAME} or catalogue or promised or effect_has or every_edit or full_batch or every_parameter or all_starts"
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
        timeout=600,
    )
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-1000:]
    listed = subprocess.run(
        [sys.executable, "-m", "spacerobot", "prove", "--list"],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert NAME in listed.partition("not yet proved:")[2].split()


def test_every_test_of_the_whole_catalogue_is_among_them() -> None:
    """Whatever is asked of all effects at once is asked of the newcomer."""
    asks = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "tests").rglob("test_*.py")
        if re.search(r"all_effects\(\)(?!\[)", path.read_text(encoding="utf-8")) and path != Path(__file__)
    }
    assert asks == set(REGISTRY_WIDE)


def test_the_lists_are_the_catalogue() -> None:
    from spacerobot.effects.registry import all_effects
    from spacerobot.proof.proved import not_yet_proved, proved

    assert set(proved()) | set(not_yet_proved()) == set(all_effects())
    assert not set(proved()) & set(not_yet_proved())
    assert "wrist" in proved()["coulomb_friction"]
