"""docs/learned.md, walked: what the page says is printed is what is printed, and the draft is an effect."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "learned.md").read_text(encoding="utf-8")


def _numbers(text: str) -> list[float]:
    return [float(x) for x in re.findall(r"-?\d+\.\d+", text)]


@pytest.mark.slow
def test_the_page_says_what_the_command_prints(tmp_path: Path) -> None:
    (said,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    command = [sys.executable, "-m", "spacerobot"]
    study = ROOT / "examples" / "studies" / "return-stroke"
    done = subprocess.run(
        [*command, "diagnose", str(study), "--out", "return-stroke"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=3000,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    printed = done.stdout.replace(f"{tmp_path}/", "").splitlines()
    for line in said.splitlines():
        name = re.sub(r"[\d.]+", "#", line)
        (same,) = [one for one in printed if re.sub(r"[\d.]+", "#", one) == name]
        assert _numbers(same) == pytest.approx(_numbers(line), rel=2e-3)
    draft = [*command, "effects", "--effects", "return-stroke/my_law.py"]
    listed = subprocess.run(draft, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert "my_law" in listed.stdout, listed.stderr
