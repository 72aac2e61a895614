"""File formats, from what writes and checks them."""

from __future__ import annotations

from typing import Any

from spacerobot.diagnosis.answer.schema import schema
from spacerobot.simulation.scene import Scene
from spacerobot.simulation.scene_units import UNITS


def scene_file() -> str:
    """The scene file of the default scene, each number with its unit; then the keys that it does not state."""
    lines, stated, table = [], set(), ""
    for line in Scene().to_toml().strip().splitlines():
        if line.startswith("["):
            table = line.strip("[]") + "."
        key = table + line.partition(" = ")[0]
        stated.add(key)
        lines.append(f"{line:40} # {_said(UNITS[key])}" if key in UNITS else line)
    further = [f"| `{key}` | {_said(unit)} |" for key, unit in UNITS.items() if key not in stated]
    return "\n".join(["```toml", *lines, "```", "", "| further key | unit |", "|---|---|", *further])


def _said(unit: str) -> str:
    return "no unit" if unit == "1" else unit


def verdict_file() -> str:
    """The keys of verdict.json, from its JSON Schema."""
    found = schema()
    rows = []
    for name, rule in found["properties"].items():
        must = "yes" if name in found.get("required", ()) else ""
        rows.append(f"| `{name}` | {_kind(found, rule)} | {must} | {_words(rule)} |")
    return "\n".join(["| key | type | always | |", "|---|---|---|---|", *rows])


def _words(rule: Any) -> str:
    return str(rule.get("description", "")).replace("|", "\\|") if isinstance(rule, dict) else ""


def _kind(whole: dict[str, Any], rule: Any) -> str:
    if not isinstance(rule, dict):
        return ""
    if "$ref" in rule:
        return _kind(whole, whole["$defs"][rule["$ref"].rsplit("/", 1)[-1]])
    if "enum" in rule:
        return ", ".join(f"`{v}`" for v in rule["enum"])
    if "const" in rule:
        return f"`{rule['const']}`"
    for key in ("oneOf", "anyOf"):
        if key in rule:
            return " or ".join(dict.fromkeys(filter(None, (_kind(whole, r) for r in rule[key]))))
    kind = rule.get("type", "")
    return " or ".join(kind) if isinstance(kind, list) else str(kind)
