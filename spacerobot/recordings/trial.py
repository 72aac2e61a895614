"""A trial: one run of the rig, what was different about it, and its files."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from spacerobot.recordings.baseline import read_pose
from spacerobot.recordings.dataroot import inside
from spacerobot.recordings.document import Document, flatten
from spacerobot.recordings.run_index import read_index
from spacerobot.recordings.stream import StreamSpec, read_rows
from spacerobot.recordings.values import GROUPS, read_values
from spacerobot.support.errors import InputError, NotFoundError

_GROUPS = tuple(dict.fromkeys(group.split(".")[0] for group in GROUPS))
_KEYS = ("id", "condition", "pose", "pose_deg", "window", "step", "each", "offset", "index")
_SOURCE_KEYS = ("file", "variable", "rows", "time_file")
_COUNTER = re.compile(r"\{n(?::(0?)(\d{1,2})d?)?\}")
_MAXIMUM_TRIALS = 20_000


@dataclass(frozen=True)
class Source:
    """Where a trial's data of one stream are.

    Attributes:
        file: path relative to the data root.
        variable: array inside the file, overriding the stream's.
        rows: rows of the file, overriding the stream's.
        time_file: file that holds the times, one a row, where they are kept apart.
    """

    file: str
    variable: str | None = None
    rows: tuple[int, int | None] | None = None
    time_file: str | None = None


@dataclass(frozen=True)
class Trial:
    """One trial.

    Attributes:
        id: its name in the study.
        overrides: dotted name -> value that replaces the baseline's, SI.
        sources: stream -> where its data are.
        condition: what it shares with its like, None for the default (its target mass).
        pose: joint positions, rad; None for the baseline's.
        window: first and last time that count, s, in the recording's own time; None for all.
        where: file and line.
        offsets: channel -> offset of this trial alone, added to the channel's own and in its unit.
    """

    id: str
    overrides: Mapping[str, float] = field(default_factory=dict)
    sources: Mapping[str, Source] = field(default_factory=dict)
    condition: str | None = None
    pose: tuple[float, ...] | None = None
    window: tuple[float, float] | None = None
    where: str | None = None
    offsets: Mapping[str, float] = field(default_factory=dict)


def read_trials(document: Document, streams: Mapping[str, StreamSpec], root: Path) -> tuple[Trial, ...]:
    """The `[[trials]]` of a study, in order, checked.

    Args:
        document: the study.
        streams: by name.
        root: folder that stream files and index files are relative to.

    Raises:
        InputError: none at all, one name twice, an unknown key or stream, an index file that cannot be read.
    """
    tables = document.data.get("trials", [])
    if not isinstance(tables, list) or not all(isinstance(t, dict) for t in tables):
        raise InputError("trials must be written as [[trials]]", where=document.where("trials"))
    found: list[Trial] = []
    seen: set[str] = set()
    for index, table in enumerate(tables):
        for trial in _expand(document, index, table, streams, root):
            if trial.id in seen:
                raise InputError("two trials have the same id", given=trial.id, where=trial.where)
            seen.add(trial.id)
            found.append(trial)
            if len(found) > _MAXIMUM_TRIALS:
                raise InputError("too many trials", valid=f"at most {_MAXIMUM_TRIALS}", where=trial.where)
    if not found:
        raise InputError("the study has no trials", valid='[[trials]] with id = "01"', where=str(document.path))
    return tuple(found)


def index_file(document: Document, table: Mapping[str, Any], root: Path, *path: str | int) -> Path | None:
    """The file that a `[[trials]]` table takes its trials from, inside the data root; None where it has none."""
    if "index" not in table:
        return None
    where = document.where(*path, "index")
    if not isinstance(table["index"], str) or "each" in table:
        valid = 'index = "FILE", without "each"'
        raise InputError("'index' must be the file that lists the runs", given=table["index"], valid=valid, where=where)
    return inside(root, table["index"], where=where)


def _listed(
    document: Document, index: int, table: Mapping[str, Any], streams: Mapping[str, StreamSpec], file: Path
) -> list[Trial]:
    """A trial for each row of an index file."""
    texts = ("id", "condition", *streams)
    rest = {k: v for k, v in table.items() if k != "index"}
    found = []
    for row in read_index(file):
        filled = {k: row.fill(v, k in texts, k) for k, v in rest.items()}
        try:
            found.append(_trial(document, index, {k: v for k, v in filled.items() if v is not None}, streams))
        except NotFoundError:  # a key of the study, which no row can mend
            raise
        except InputError as error:
            raise InputError(error.what, given=error.given, valid=error.valid, where=row.where) from None
    return found


def _expand(
    document: Document, index: int, table: Mapping[str, Any], streams: Mapping[str, StreamSpec], root: Path
) -> list[Trial]:
    """One trial; or one a row of `index = FILE`; or one a number of `each = [first, last]`, with {n} or {n:03d}
    replaced in its texts.
    """
    path = ("trials", index)
    file = index_file(document, table, root, *path)
    if file is not None:
        return _listed(document, index, table, streams, file)
    if "each" not in table:
        if "step" in table:
            raise InputError("'step' belongs to 'each'", given=table["step"], where=document.where(*path, "step"))
        return [_trial(document, index, table, streams)]
    ends = table["each"]
    whole = isinstance(ends, list) and len(ends) == 2 and all(type(v) is int and v >= 0 for v in ends)
    if not whole or ends[1] < ends[0] or ends[1] - ends[0] >= _MAXIMUM_TRIALS:
        raise InputError("'each' must be [first, last], whole numbers", given=ends, where=document.where(*path, "each"))
    rest = {k: v for k, v in table.items() if k not in ("each", "step")}
    step = _step(document, table, *path)
    return [
        _trial(document, index, _count(_stepped(rest, step * (n - ends[0])), n), streams)
        for n in range(ends[0], ends[1] + 1)
    ]


def _step(document: Document, table: Mapping[str, Any], *path: str | int) -> float:
    """Seconds from one trial's window to the next one's."""
    if "step" not in table:
        return 0.0
    step = document.number(table["step"], *path, "step")
    if "window" not in table or step == 0:
        where = document.where(*path, "step")
        raise InputError("'step' moves the window of 'each'", given=step, valid="window = [a, b]", where=where)
    return step


def _stepped(table: Mapping[str, Any], by: float) -> dict[str, Any]:
    """The table with its window moved."""
    window = table.get("window")
    if by and isinstance(window, list) and all(isinstance(v, int | float) for v in window):
        return {**table, "window": [v + by for v in window]}
    return dict(table)


def _count(value: Any, n: int) -> Any:
    if isinstance(value, dict):
        return {k: _count(v, n) for k, v in value.items()}
    if not isinstance(value, str):
        return value
    return _COUNTER.sub(lambda m: str(n).rjust(int(m.group(2) or 0), "0" if m.group(1) else " "), value)


def _trial(document: Document, index: int, table: Mapping[str, Any], streams: Mapping[str, StreamSpec]) -> Trial:
    path = ("trials", index)
    where = document.where(*path)
    identity = table.get("id")
    if type(identity) is int:
        identity = str(identity)
    if not isinstance(identity, str) or not re.fullmatch(r"[\w.+=, -]{1,80}", identity) or identity.strip(". ") == "":
        raise InputError(
            "a trial needs an id",
            given=identity,
            valid="letters, digits and _ . + = - , at most 80",
            where=document.where(*path, "id"),
        )
    known = (*_KEYS, *_GROUPS, *streams)
    physical: dict[str, Any] = {}
    sources: dict[str, Source] = {}
    for key, value in table.items():
        if key in streams:
            sources[key] = _source(document, value, *path, key)
        elif key.split(".")[0] in _GROUPS:
            physical[key] = value
        elif key not in _KEYS:
            raise NotFoundError("key", key, known, where=document.where(*path, key))
    if not sources:
        raise InputError("the trial names no file", given=identity, valid=f"{' or '.join(streams)} = FILE", where=where)
    stated, pose = read_pose(document, table, *path)
    condition = table.get("condition")
    if isinstance(condition, bool) or not isinstance(condition, str | int | float | None):
        raise InputError(
            "'condition' must be text or a number", given=condition, where=document.where(*path, "condition")
        )
    try:
        flat = flatten(physical)
    except InputError as error:
        raise InputError(error.what, given=error.given, where=where) from None
    return Trial(
        id=identity,
        overrides=read_values(document, flat, *path),
        sources=sources,
        condition=None if condition is None else str(condition),
        pose=pose if stated else None,
        window=_window(document, table, *path),
        where=where,
        offsets=_offsets(document, table, {n: streams[n] for n in sources}, *path),
    )


def _offsets(
    document: Document, table: Mapping[str, Any], streams: Mapping[str, StreamSpec], *path: str | int
) -> dict[str, float]:
    """`offset = { "target.x" = -0.03 }`: channel -> offset of this trial alone."""
    known = [c.name for s in streams.values() for c in s.channels]
    found: dict[str, float] = {}
    for name, value in flatten(document.table(table, "offset", *path)).items():
        if name not in known:
            raise NotFoundError("channel of this trial", name, known, where=document.where(*path, "offset"))
        found[name] = document.number(value, *path, "offset")
    return found


def _window(document: Document, table: Mapping[str, Any], *path: str | int) -> tuple[float, float] | None:
    if "window" not in table:
        return None
    first, last = document.vector(table["window"], 2, *path, "window")
    if not first < last:
        raise InputError(
            "'window' must be [first, last] in s", given=[first, last], where=document.where(*path, "window")
        )
    return first, last


def _source(document: Document, value: object, *path: str | int) -> Source:
    where = document.where(*path)
    table = {"file": value} if isinstance(value, str) else value
    if not isinstance(table, dict):
        raise InputError(
            "a stream's data must be a file",
            given=value,
            valid='"FILE" or { file = "FILE", ... }',
            where=where,
        )
    document.check_keys(table, _SOURCE_KEYS, *path)
    for key in ("file", "variable", "time_file"):
        text = table.get(key, "x")
        if not isinstance(text, str) or not text or "\0" in text or len(text) > 1000:
            raise InputError(f"{key!r} must be text", given=text, where=where)
    if "file" not in table:
        raise InputError("a stream's data must name a file", given=value, where=where)
    return Source(
        file=table["file"],
        variable=table.get("variable"),
        rows=read_rows(document, table["rows"], *path, "rows") if "rows" in table else None,
        time_file=table.get("time_file"),
    )
