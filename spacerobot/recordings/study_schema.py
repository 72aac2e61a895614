"""study.toml as a JSON Schema, made from the tables that its reader checks keys by: for editors and whoever writes one.

A file that the reader takes is valid. What only hangs together (a trial's files are of streams that the study has, a
unit measures its channel, a time never runs backwards) the schema cannot see: `spacerobot study check` says it.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import Any

from spacerobot.recordings import baseline, gears, stream, study, trial
from spacerobot.recordings.schema_rules import (
    BASELINE,
    CELL,
    CHANNEL,
    GEARS,
    SOURCE,
    STREAM,
    TOP,
    TRIAL,
    Rule,
    choice,
    text,
)
from spacerobot.recordings.sigmas import TURNED
from spacerobot.recordings.values import GROUPS, Kind

ANY = "NAME"
"""Stands for a name of the user's own in `values.GROUPS`."""

ITSELF = ""
"""Key of a branch under which the rule of the name that ends there stands."""

Tree = dict[str, Any]


@functools.cache
def study_schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of study.toml, read as TOML and checked as what it holds."""
    law: Rule = choice("law of the contact", baseline.LAWS)
    found: dict[str, Any] = {}
    values = _tree("value", _believed, found, {"contact": {"law": law}})
    deviations, scatters = _tree("sigma", _deviation, found), _tree("scatter", _scatter, found)
    of_a_trial = _tree("of_a_trial", lambda kind, name: _or_cells(_believed(kind, name)), found)
    found |= {
        "baseline": _table(
            baseline._PLAIN, BASELINE, values, _within("sigma", deviations), _within("scatter", scatters)
        ),
        "gears": {**_keys(gears._KEYS, GEARS), "required": ["streams", "joints", "ratio"]},
        "stream": {
            **_keys(stream._KEYS, {**STREAM, "channels": {"$ref": "#/$defs/columns", "minProperties": 1}}),
            "required": ["channels"],
            "anyOf": [
                {"required": ["time"]},
                {"required": ["rate"]},
                {"required": ["kind"], "properties": {"kind": {"const": "events"}}},
            ],
        },
        "channel": {**_keys(stream._CHANNEL_KEYS, CHANNEL), "required": ["is"]},
        "columns": {
            "type": "object",
            "description": "columns by name, by index, or by a dotted name unquoted: each a channel, or a list of them",
            "additionalProperties": {
                "anyOf": [
                    {"$ref": "#/$defs/channel"},
                    {"type": "array", "items": {"$ref": "#/$defs/channel"}, "minItems": 1},
                    {"$ref": "#/$defs/columns", "minProperties": 1},
                ]
            },
        },
        "trial": _trial(of_a_trial),
    }
    of_streams = {
        "type": "object",
        "minProperties": 1,
        "propertyNames": {"pattern": r"^[\w-]{1,40}$", "not": {"enum": [*trial._KEYS, *trial._GROUPS]}},
        "additionalProperties": {"$ref": "#/$defs/stream"},
        "description": "how files of one kind are read, by a name of yours",
    }
    tables: dict[str, Rule] = {
        "format": {"const": study.FORMAT, "description": "of this file"},
        "baseline": {"$ref": "#/$defs/baseline", "description": "what the lab believes of its machine, SI"},
        "gears": {"$ref": "#/$defs/gears", "description": "how logged motors turn the joints"},
        "streams": of_streams,
        "trials": {"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/trial"}},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:spacerobot:study:{study.FORMAT}",
        "title": "A study of spacerobot",
        "description": "study.toml: what a lab believes of its machine and what it recorded. Units stand in brackets; "
        "values of a joint that slides are in N, m and kg, of one that turns in N m, rad and kg m^2.",
        **_keys(study._TOP, {**TOP, **tables}),
        "required": ["baseline", "streams", "trials"],
        "$defs": found,
    }


def _keys(known: tuple[str, ...], rules: Mapping[str, Rule]) -> Rule:
    """An object of these keys and no others; a key without a rule raises."""
    return {"type": "object", "properties": {key: rules[key] for key in known}, "additionalProperties": False}


def _table(known: tuple[str, ...], rules: Mapping[str, Rule], *trees: Rule) -> Rule:
    """An object of plain keys and of dotted values, nested or quoted."""
    found: Rule = {"type": "object", "properties": {key: rules[key] for key in known}, "patternProperties": {}}
    for tree in trees:
        found["properties"] |= tree["properties"]
        found["patternProperties"] |= tree["patternProperties"]
    return {**found, "additionalProperties": False}


def _within(key: str, tree: Rule) -> Rule:
    """An object of one key."""
    return {"properties": {key: tree}, "patternProperties": {}}


def _trial(values: Rule) -> Rule:
    """A trial: every number may be a cell of an index; any other key is a stream, with its file."""
    rules = {key: _or_cells(rule) for key, rule in TRIAL.items()}
    channel = {"anyOf": [{"type": "number"}, CELL, {"$ref": "#/$defs/trial/properties/offset"}]}
    rules["offset"] = {**TRIAL["offset"], "additionalProperties": channel}
    source = {**_keys(trial._SOURCE_KEYS, {k: _or_cells(r) for k, r in SOURCE.items()}), "required": ["file"]}
    found = _table(trial._KEYS, rules, values)
    file = {"anyOf": [text("the file of a stream", minLength=1), source]}
    return {**found, "additionalProperties": file, "required": ["id"]}


def _or_cells(rule: Any) -> Any:
    """A rule in which a cell of an index may stand for each number."""
    if not isinstance(rule, dict):
        return [_or_cells(r) for r in rule] if isinstance(rule, list) else rule
    if rule.get("type") in ("number", "integer"):
        return {"anyOf": [rule, CELL]}
    return {key: _or_cells(inner) if key not in ("enum", "required") else inner for key, inner in rule.items()}


def _tree(
    what: str,
    rule: Callable[[Kind, str], Rule],
    found: dict[str, Any],
    more: Mapping[str, Mapping[str, Rule]] = MappingProxyType({}),
) -> Rule:
    """All values that may be believed, however their dotted names are cut into tables and quoted keys.

    Args:
        what: is said of them; begins their names among the definitions.
        rule: of one, by its kind and dotted name.
        found: definitions, which theirs are put among.
        more: by group, rules of keys that are no values.
    """
    whole: Tree = {}
    for group, table in GROUPS.items():
        branch = functools.reduce(lambda at, word: at.setdefault(word, {}), group.split("."), whole)
        for key, kind in table.items():
            name = f"{group}.{key}"
            leaf = branch.setdefault(key, {})
            leaf[ITSELF] = rule(kind, name)
            for part in kind.parts:
                leaf[part] = {ITSELF: rule(Kind(kind.minimum, kind.strict, kind.unit), f"{name}.{part}")}
        for key, further in more.get(group, {}).items():
            branch[key] = {ITSELF: further}
    for words, below in _below(whole):
        found[_named(what, words)] = _node(below, what, words)
    return _branch(whole, what, ())


def _named(what: str, words: tuple[str, ...]) -> str:
    return ".".join((what, *words))


def _branch(tree: Tree, what: str, at: tuple[str, ...]) -> Rule:
    """A table of a tree: what lies below by the next word, and by several words in one quoted key."""
    found: Rule = {"type": "object", "properties": {}, "patternProperties": {}, "additionalProperties": False}
    for words, _ in _below(tree):
        rule = {"$ref": f"#/$defs/{_named(what, (*at, *words))}"}
        if len(words) == 1 and ANY not in words:
            found["properties"][words[0]] = rule
        else:
            pattern = r"\.".join(r"[^.]+" if word == ANY else re.escape(word) for word in words)
            found["patternProperties"][f"^{pattern}$"] = rule
    return found


def _node(tree: Tree, what: str, at: tuple[str, ...]) -> Rule:
    """What stands under a name: its own rule, a table of what lies below, or either."""
    deeper = [_branch(tree, what, at)] if set(tree) - {ITSELF} else []
    own = [tree[ITSELF]] if ITSELF in tree else []
    (first, *second) = own + deeper
    return {"anyOf": [first, *second]} if second else first


def _below(tree: Tree, words: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Tree]]:
    """Everything below a tree with the words that lead there."""
    for word, inner in tree.items():
        if word != ITSELF:
            yield (*words, word), inner
            yield from _below(inner, (*words, word))


def _believed(kind: Kind, name: str) -> Rule:
    """A value, a vector's components, or "unknown"."""
    least = {} if kind.minimum is None else {"exclusiveMinimum" if kind.strict else "minimum": kind.minimum}
    words = f"{name} [{_unit(kind, name)}]"
    one: Rule = {"type": "number", **least}
    if kind.parts:
        size = len(kind.parts)
        one = {"type": "array", "items": one, "minItems": size, "maxItems": size}
        words += f": {', '.join(kind.parts)}"
    return {"anyOf": [one, {"const": "unknown"}], "description": f"{words}; unknown, or absent: it is fitted"}


def _deviation(kind: Kind, name: str) -> Rule:
    """How well a value is known."""
    size = {"type": "string", "pattern": r"^\s*[0-9.eE+-]+\s+\S"}
    words = f'one standard deviation of {name}: a share of it [1], or a size with its unit such as "0.1 {kind.unit}"'
    return {"anyOf": [{"type": "number", "minimum": 0}, size], "description": words}


def _scatter(kind: Kind, name: str) -> Rule:
    """How much a value changes between conditions."""
    words = f"one standard deviation of {name} between conditions, as a share of it [1]"
    return {"type": "number", "minimum": 0, "description": words}


def _unit(kind: Kind, name: str) -> str:
    """Its unit; of a joint's value, that where it slides and that where it turns."""
    if name.startswith("joint.") and kind.unit == "rad":
        return "rad, or m of a joint that slides"
    turned = {**TURNED, "N": "N m", "m": "rad"}.get(kind.unit) if name.startswith("joint.") else None
    return f"{kind.unit}, or {turned} of a joint that turns" if turned else kind.unit
