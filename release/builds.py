"""Builds that repeat: sdist and wheel made twice, in two places, must be the same bytes.

python -m release.builds [--out DIR]; what is built is the last commit, not the working folder.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def checked_out(where: Path) -> str:
    """The last commit's files in `where`; returns its time, in seconds since 1970."""
    archive = where.with_suffix(".tar")
    subprocess.run(["git", "archive", "--output", str(archive), "HEAD"], cwd=ROOT, check=True)
    with tarfile.open(archive) as tar:
        tar.extractall(where, filter="data")
    archive.unlink()
    said = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=True)
    return said.stdout.strip()


def built(place: Path) -> dict[str, str]:
    """Name -> SHA-256 of sdist and wheel, the wheel by way of the sdist; from a copy of the last commit in `place`."""
    source, out = place / "source", place / "dist"
    source.mkdir(parents=True)
    epoch = checked_out(source)
    environment = {**os.environ, "SOURCE_DATE_EPOCH": epoch}
    command = [sys.executable, "-m", "build", "--outdir", str(out), str(source)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"the build failed:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(out.iterdir())}


def main() -> int:
    """Build twice and compare; 1 where they differ."""
    parser = argparse.ArgumentParser(prog="python -m release.builds")
    parser.add_argument("--out", type=Path, metavar="DIR", help="put sdist and wheel there")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        first = built(Path(folder) / "one")
        second = built(Path(folder) / "another" / "place")
        for name in sorted(first.keys() | second.keys()):
            same = first.get(name) == second.get(name)
            print(f"{name}: {first.get(name)} {'twice' if same else f'and then {second.get(name)}'}")
        if args.out is not None and first == second:
            args.out.mkdir(parents=True, exist_ok=True)
            for name in first:
                shutil.copy(Path(folder) / "one" / "dist" / name, args.out / name)
    return 0 if first == second else 1


if __name__ == "__main__":
    sys.exit(main())
