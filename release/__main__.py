"""The release check-list as one command: python -m release, also as make release-check.

Every step runs even if one before it fails; ends with a table and exit code 1 if any did.
"""

from __future__ import annotations

import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PYTHON = sys.executable

STEPS: dict[str, list[str]] = {
    "linter": [PYTHON, "-m", "ruff", "check", "."],
    "types": [PYTHON, "-m", "mypy"],
    "licences": [PYTHON, "-m", "release.licences"],
    "vulnerabilities": [PYTHON, "-m", "release.audit"],
    "sdist and wheel, twice": [PYTHON, "-m", "release.builds", "--out", "dist"],
    "wheel in an environment of its own": ["bash", ".ci/check_wheel"],
    "tests": [PYTHON, "-m", "pytest", "-m", "not slow"],
}


def versions() -> list[str]:
    """What does not agree about the version, and what is not committed."""
    said = {
        "pyproject.toml": _found(r'^version = "([^"]+)"', "pyproject.toml"),
        "spacerobot/__init__.py": _found(r'^__version__ = "([^"]+)"', "spacerobot/__init__.py"),
        "CITATION.cff": _found(r"^version: \"?([^\"\n]+)", "CITATION.cff"),
    }
    faults = []
    stated = {version for version in said.values() if version}
    if len(stated) != 1:
        faults.append(f"versions differ: {said}")
    if not _found(rf"^## .*{re.escape(str(said['pyproject.toml']))}", "CHANGELOG.md"):
        faults.append(f"CHANGELOG.md has no section for {said['pyproject.toml']}")
    left = subprocess.run(["git", "status", "--porcelain"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    if left.strip():
        faults.append(f"{len(left.splitlines())} files are not committed, and would not be part of it")
    return faults


def _found(pattern: str, file: str) -> str | None:
    match = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    return match.group(1 if match.re.groups else 0) if match else None


def main() -> int:
    """Go through the list."""
    wanted = sys.argv[1:] or ["versions", *STEPS]
    unknown = set(wanted) - {"versions", *STEPS}
    if unknown:
        sys.exit(f"no such step: {', '.join(unknown)}; there are: versions, {', '.join(STEPS)}")
    results: list[tuple[str, bool, float]] = []
    for name in wanted:
        print(f"\n== {name}", flush=True)
        began = time.monotonic()
        if name == "versions":
            faults = versions()
            print("\n".join(faults) or "one version everywhere, and nothing left to commit")
            passed = not faults
        else:
            passed = subprocess.run(STEPS[name], cwd=ROOT, check=False).returncode == 0
        results.append((name, passed, time.monotonic() - began))
    print()
    for name, passed, seconds in results:
        print(f"{'passed' if passed else 'FAILED'}  {name}  ({seconds:.0f} s)")
    return 0 if all(passed for _, passed, _ in results) else 1


if __name__ == "__main__":
    sys.exit(main())
