"""The promise of verdict.json as a JSON Schema, and the check of a verdict against it."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, get_args

import msgspec

from spacerobot.diagnosis.answer.record import FORMAT, Verdict
from spacerobot.diagnosis.terms.kinds import AMBIGUOUS, LEARNED, NAMED, WRONG_PARAMETER, Kind
from spacerobot.support.errors import InputError
from spacerobot.support.formats import require_format
from spacerobot.support.json_schema import checker
from spacerobot.support.jsonio import plain

VERDICTS: tuple[str, ...] = get_args(Kind)
"""Every kind of verdict."""

PROMISED: dict[int, tuple[frozenset[str], frozenset[str]]] = {
    1: (
        frozenset({"named", "learned", "ambiguous", "unknown", "nothing_missing", "wrong_parameter", "not_trusted"}),
        frozenset({"format", "spacerobot", "input_hash", "seed", "study", "seconds", "verdict", "confidence"})
        | {"effects", "alternatives", "parameters", "located", "held_out", "detectable", "next_experiment"}
        | {"parts", "learned", "exact", "moved", "covariance", "why", "not_predicted", "not_located"}
        | {"events", "clocks", "model", "assumed", "spoiled", "noise"},
    ),
}
"""Format -> kinds of verdict and keys of the whole that its readers have been told of, some of them to come."""


_RULES: tuple[dict[str, Any], ...] = (
    {
        "if": {"properties": {"verdict": {"enum": [NAMED, LEARNED]}}},
        "then": {"properties": {"effects": {"minItems": 1}}},
        "else": {"properties": {"effects": {"maxItems": 0}}},
    },
    {
        "if": {"properties": {"verdict": {"const": AMBIGUOUS}}},
        "then": {"properties": {"alternatives": {"minItems": 2}}},
    },
    {
        "if": {"properties": {"verdict": {"const": WRONG_PARAMETER}}},
        "then": {"properties": {"parameters": {"minProperties": 1}}},
    },
)
"""What a kind of verdict asks of the keys beside it."""


@functools.cache
def schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of verdict.json, made from the record that writes it."""
    _, found = msgspec.json.schema_components([Verdict], ref_template="#/$defs/{name}")
    whole = found.pop(Verdict.__name__)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:spacerobot:verdict:{FORMAT}"}
    return {**head, **whole, "title": "Verdict of spacerobot diagnose", "allOf": list(_RULES), "$defs": found}


@functools.cache
def _validator() -> Any:
    return checker(schema())


def validate(verdict: Mapping[str, Any], where: str = "verdict") -> None:
    """Check a verdict, a dict as read from verdict.json or about to be written there.

    Args:
        verdict: the object; NumPy values are taken as `support.jsonio` would write them.
        where: named in the error, a file for instance.

    Raises:
        InputError: the first breach, with the path to it.
    """
    if isinstance(verdict.get("format"), int):  # else it is no verdict, and the breach says so
        require_format(verdict["format"], FORMAT, "verdict", f"{where}.format", "diagnose the study again")
    breaches = _validator().iter_errors(plain(dict(verdict)))
    breach = min(breaches, key=_rank, default=None)
    if breach is None:
        return
    while breach.context:  # inside a oneOf: the breach of the branch that came nearest says more
        breach = max(breach.context, key=lambda e: len(e.absolute_path))
    path = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in breach.absolute_path)
    raise InputError(f"not a valid verdict: {breach.message}", where=f"{where}{path}")


def _rank(breach: Any) -> tuple[bool, list[str]]:
    """Plain breaches before those of the rules between keys, which may only follow from them."""
    return breach.absolute_schema_path[0] == "allOf", [str(p) for p in breach.absolute_path]
