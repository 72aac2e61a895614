"""From a file of named arrays to a table of columns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from spacerobot.recordings.readers import limits
from spacerobot.recordings.table import Column, Floats, Options, RawTable
from spacerobot.support.errors import InputError, NotFoundError

_WIDEST = 400


def arrays_to_table(
    path: Path, arrays: Mapping[str, Floats], options: Options, notes: tuple[str, ...] = ()
) -> RawTable:
    """Columns of the file's arrays.

    Vectors are columns by their own name. A matrix `x` gives its columns as "x[j]" and "x[:,j]" and its rows
    as "x[i,:]". With `options.variable` that array's columns come first (so that they go by index alone),
    followed by the other vectors of the same length. Where `options.variable` is a struct or a group, its fields are
    the arrays, without its name.

    Args:
        path: the file.
        arrays: dotted name -> array of numbers; those of more than two dimensions are left out.
        options: `variable`, `rows` and `reshape` count here.
        notes: remarks for the user.

    Raises:
        NotFoundError: no array of that name.
        InputError: the file has no arrays of numbers, or the array is no table.
    """
    if not arrays:
        raise InputError("the file holds no arrays of numbers", where=str(path))
    if options.variable is None:
        columns = [c for name, array in arrays.items() for c in _columns(name, array)]
    else:
        inside = f"{options.variable}."
        members = {name.removeprefix(inside): own for name, own in arrays.items() if name.startswith(inside)}
        if members:
            return arrays_to_table(path, members, replace(options, variable=None), notes)
        if options.variable not in arrays:
            raise NotFoundError(f"array of {path.name}", options.variable, arrays, where=str(path))
        columns = _columns(options.variable, _reshaped(path, arrays[options.variable], options))
        length = len(columns[0].values) if columns else 0
        for name, array in arrays.items():
            if name != options.variable and _is_vector(array) and array.size == length:
                columns += _columns(name, array)
    if not columns:
        raise InputError(
            "the array is not a table of at most two dimensions",
            given=options.variable or "no variable",
            valid=f"one of {', '.join(list(arrays)[:20])}",
            where=str(path),
        )
    if options.rows is not None:
        first, last = options.rows
        columns = [Column(c.names, c.values[first:last], c.unit) for c in columns]
    return RawTable(path, tuple(columns), None, notes)


def as_floats(array: object) -> Floats | None:
    """Numbers of any kind as float64, None for what is no real array of numbers (text, objects, complex)."""
    values = np.asarray(array)
    if values.dtype.kind not in "biuf" or values.size == 0 or values.size > limits.ARRAY_VALUES:
        return None
    return np.ascontiguousarray(values, dtype=np.float64)


def _is_vector(array: Floats) -> bool:
    return array.ndim <= 1 or (array.ndim == 2 and min(array.shape) == 1)


def _columns(name: str, array: Floats) -> list[Column]:
    if _is_vector(array):
        return [Column((name, f"{name}[0]"), array.reshape(-1))]
    if array.ndim != 2:
        return []
    rows, width = array.shape
    found: list[Column] = []
    if width <= _WIDEST:
        found += [Column((f"{name}[{j}]", f"{name}[:,{j}]"), np.ascontiguousarray(array[:, j])) for j in range(width)]
    if rows <= _WIDEST and rows < width:
        found += [Column((f"{name}[{i},:]",), array[i]) for i in range(rows)]
    return found


def _reshaped(path: Path, array: Floats, options: Options) -> Floats:
    count = options.reshape or 1
    if count == 1:
        return array
    if not _is_vector(array) or array.size % count:
        raise InputError(f"the values do not come in groups of {count}", given=f"shape {array.shape}", where=str(path))
    return array.reshape(-1, count)
