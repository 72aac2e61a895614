"""RFC 8259 JSON: infinity as "inf", never NaN; arrays and dataclasses accepted."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any


def plain(value: Any) -> Any:
    """`value` as JSON-ready builtins: arrays to lists, infinity to "inf"/"-inf", NaN to None."""
    import numpy as np  # here, so that a command that only shows its help need not load it

    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, float | np.floating):
        number = float(value)
        if math.isfinite(number):
            return number
        return None if math.isnan(number) else ("inf" if number > 0 else "-inf")
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(v) for v in value]
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"cannot be written as JSON: {type(value).__name__}")


def dumps(value: Any, *, indent: int | None = 1) -> str:
    """`value` as RFC 8259 text."""
    return json.dumps(plain(value), indent=indent, allow_nan=False, ensure_ascii=False)
