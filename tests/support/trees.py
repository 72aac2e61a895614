"""Folders as strangers leave them: files, links, leftovers and locks, and a look that sees every change."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

Entry = tuple[str, str, Any]
"""Path inside the folder, "file", "link" or "folder", and content or target."""

_NAMES = (
    ".lock",
    ".x.part",
    ".verdict.json.abcdefgh.part",
    ".run.json.abcdefgh.part",
    "run.json",
    "verdict.json",
    "partial/fit-0123456789ab.txt",
    "partial/notes",
    "plots/.a.png.part",
    "deep/er/.lock",
    "deep/er/.y.part",
    "thesis.tex",
)
_MARKERS = [
    b"",
    b"[1",
    json.dumps({"state": "finished", "outputs": {"thesis.tex": 5}}).encode(),
    json.dumps({"state": "finished", "outputs": {"../elsewhere/kept": 4}, "sha256": {}}).encode(),
    json.dumps({"state": "finished", "command": "diagnose", "outputs": {"plots": 1, "deep/er/.lock": 3}}).encode(),
]


def trees() -> st.SearchStrategy[list[Entry]]:
    """Trees of one to six entries; at least one of them is a thesis."""
    content = st.one_of(st.binary(max_size=20), st.sampled_from(_MARKERS))
    file = st.tuples(st.sampled_from(_NAMES), st.just("file"), content)
    target = st.sampled_from(["elsewhere", "elsewhere/kept", "nowhere"])
    link = st.tuples(st.sampled_from(_NAMES), st.just("link"), target)
    some = st.lists(st.one_of(file, link), max_size=6, unique_by=lambda e: e[0])
    return some.map(lambda found: [*(e for e in found if e[0] != "paper.tex"), ("paper.tex", "file", b"years of work")])


def plant(top: Path, tree: Iterable[Entry]) -> None:
    """Make the tree in `top/out`, beside a folder `top/elsewhere` that links may lead to."""
    (top / "elsewhere").mkdir(parents=True, exist_ok=True)
    (top / "elsewhere" / "kept").write_text("kept")
    for name, kind, what in tree:
        path = top / "out" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if kind == "file":
            path.write_bytes(what)
        elif kind == "link":
            path.symlink_to(top / what)
        else:
            path.mkdir()


def seen(top: Path, times: bool = True) -> dict[str, tuple[Any, ...]]:
    """Everything below `top`: kind, inode, times of change, content; links are not followed.

    Args:
        top: the folder.
        times: whether to look at times of change, which a file made beside and removed again would show.
    """
    found: dict[str, tuple[Any, ...]] = {}
    for folder, names, files in os.walk(top):
        for name in (*names, *files):
            path = Path(folder) / name
            told = path.lstat()
            content = os.readlink(path) if path.is_symlink() else path.read_bytes() if path.is_file() else b""
            found[str(path.relative_to(top))] = (
                told.st_mode,
                told.st_ino,
                (told.st_mtime_ns, told.st_ctime_ns) if times else (),
                content,
            )
    return found
