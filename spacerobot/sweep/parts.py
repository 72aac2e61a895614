"""Parts of a sweep as Parquet files, whose footers say what they hold; whole or not there."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from spacerobot.support.files import atomic
from spacerobot.support.jsonio import dumps
from spacerobot.sweep.engine import RESULTS

FOLDER = "collisions"
_KEY = b"spacerobot"


def part_name(number: int) -> str:
    """Where a part lies in the run's folder."""
    return f"{FOLDER}/part-{number:06d}.parquet"


def write_part(path: Path, columns: Mapping[str, np.ndarray], about: Mapping[str, Any]) -> dict[str, Any]:
    """Write a part; returns what its footer says: `about`, and count, sum, least and largest of every result."""
    footer = {**about, "results": {name: _summary(columns[name]) for name in RESULTS.values()}}
    write_table(path, columns, footer)
    return footer


def write_table(path: Path, columns: Mapping[str, np.ndarray], footer: Mapping[str, Any]) -> None:
    """Write columns as Parquet, whole or not at all."""
    table = pa.table({name: pa.array(values) for name, values in columns.items()})
    table = table.replace_schema_metadata({_KEY: dumps(footer, indent=None).encode()})
    with atomic(path, "wb") as stream:
        pq.write_table(table, stream, compression="zstd")


def footer_of(path: Path) -> dict[str, Any] | None:
    """What a part's footer says; None where there is no whole part."""
    try:
        found = pq.read_schema(path).metadata or {}
        about = json.loads(found[_KEY])
    except (OSError, KeyError, ValueError, pa.ArrowException):
        return None
    return about if isinstance(about, dict) else None


def _summary(values: np.ndarray) -> dict[str, Any]:
    finite = values[np.isfinite(values)]
    if not finite.size:
        return {"count": 0, "sum": 0.0, "min": None, "max": None}
    return {
        "count": int(finite.size),
        "sum": math.fsum(finite.tolist()),
        "min": float(finite.min()),
        "max": float(finite.max()),
    }
