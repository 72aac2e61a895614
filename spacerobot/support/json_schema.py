"""JSON Schema, draft 2020-12, by the jsonschema library."""

from __future__ import annotations

import functools
import sys
from collections.abc import Mapping
from typing import Any

_SLOW = "rfc3987_syntax"


@functools.cache
def _draft() -> Any:
    # Where Jupyter is installed, jsonschema comes with a checker of IRIs that takes longer than a second to import.
    # There are none in our schemas, and jsonschema takes its absence well.
    held = None if _SLOW in sys.modules else {_SLOW: None}
    modules: dict[str, Any] = sys.modules
    modules.update(held or {})
    try:
        from jsonschema import Draft202012Validator
    finally:
        if held:
            del sys.modules[_SLOW]
    return Draft202012Validator


def checker(schema: Mapping[str, Any]) -> Any:
    """What finds the breaches of a schema, by its `iter_errors`; the schema itself must be a valid one.

    Raises:
        jsonschema.SchemaError: it is not.
    """
    _draft().check_schema(schema)
    return _draft()(schema)
