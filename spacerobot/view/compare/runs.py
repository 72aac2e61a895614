"""Two diagnoses, or two overlays, laid side by side: what each says, and where they differ by more than they know."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spacerobot.diagnosis.answer.schema import validate
from spacerobot.diagnosis.overlay import FORMAT as OVERLAY
from spacerobot.recordings.value_units import unit_of_channel, unit_of_value
from spacerobot.support.errors import InputError
from spacerobot.support.formats import require_format
from spacerobot.support.showing import html_table
from spacerobot.view.report.words import (
    beyond,
    effect_phrase,
    finite,
    number,
    of_body,
    parameter_label,
    per_unit,
    quantity,
    with_own_units,
)

MOST_BYTES = 50_000_000
"""Of a verdict or an overlay's data; the largest of ours has a tenth of it."""

PICTURES = 8
"""Pictures of each run that a page carries."""


@dataclass(frozen=True)
class Row:
    """One line: what is compared, each run's word, and whether they differ.

    Attributes:
        what: in words.
        first, second: what each run says; a dash where it says nothing.
        differ: whether they differ: intervals that do not meet, other words; None where nothing tells.
    """

    what: str
    first: str
    second: str
    differ: bool | None = None


@dataclass(frozen=True, repr=False)
class Comparison:
    """Two runs side by side.

    Attributes:
        names: of the two folders.
        titles: of the two studies.
        sections: heading -> its lines.
        pictures: (name, first, second) as data URIs, those that both runs have.
    """

    names: tuple[str, str]
    titles: tuple[str, str]
    sections: Mapping[str, tuple[Row, ...]]
    pictures: tuple[tuple[str, str, str], ...] = ()

    def __repr__(self) -> str:
        differ = sum(bool(r.differ) for rows in self.sections.values() for r in rows)
        lines = sum(map(len, self.sections.values()))
        return f"Comparison({self.names[0]!r}, {self.names[1]!r}: {differ} of {lines} lines differ)"

    def _repr_html_(self) -> str:
        rows = [
            (name, r.what, r.first, r.second, "differ" if r.differ else "")
            for name, section in self.sections.items()
            for r in section
        ]
        return html_table(" and ".join(self.titles), rows, ("", "", *self.names, ""))

    def as_json(self) -> dict[str, Any]:
        """As `spacerobot compare --json` prints it."""
        rows = {name: [vars(r) for r in found] for name, found in self.sections.items()}
        return {"runs": list(self.names), "titles": list(self.titles), "sections": rows}


def compare(first: str | Path, second: str | Path) -> Comparison:
    """Lay two finished runs side by side.

    Args:
        first, second: folders of `spacerobot diagnose --out`, or both of `spacerobot overlay --out`.

    Raises:
        InputError: a folder holds neither, or one of each.
    """
    folders = Path(first), Path(second)
    kinds = [_kind(f) for f in folders]
    if kinds[0] != kinds[1]:
        raise InputError(
            "a diagnosis and an overlay cannot be compared", given=f"{first}: {kinds[0]}, {second}: {kinds[1]}"
        )
    a, b = (_read(f, kinds[0]) for f in folders)
    if kinds[0] == "overlay.json":
        sections = {"Residuals, rms": _overlays(a, b)}
        titles = str(a["title"]), str(b["title"])
    else:
        for found, folder in ((a, folders[0]), (b, folders[1])):
            validate(found, where=str(folder))
        a, b = (per_unit(with_own_units(of_body(found), {})) for found in (a, b))
        sections = _diagnoses(a, b)
        titles = str(a["study"]), str(b["study"])
    kept = {name: rows for name, rows in sections.items() if rows}
    resolved = [f.resolve() for f in folders]
    alike = resolved[0].name == resolved[1].name
    names = [f"{f.parent.name}/{f.name}" if alike else f.name for f in resolved]
    return Comparison((names[0], names[1]), titles, kept, _pictures(*folders))


def _kind(folder: Path) -> str:
    for name in ("verdict.json", "overlay.json"):
        if (folder / name).is_file():
            return name
    raise InputError("holds no finished diagnosis or overlay", given=str(folder), valid="a folder made with --out")


def _read(folder: Path, name: str) -> dict[str, Any]:
    path = folder / name
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError("too large", given=f"{path.stat().st_size} bytes", where=str(path))
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeError, ValueError, RecursionError) as error:
        raise InputError(f"cannot be read: {error}", where=str(path)) from None
    if not isinstance(found, dict) or (name == "overlay.json" and not {"title", "channels"} <= set(found)):
        raise InputError("is not what a run writes", where=str(path))
    if name == "overlay.json":
        require_format(found.get("format", OVERLAY), OVERLAY, "overlay", str(path), "overlay the study again")
    return found


def _diagnoses(a: Mapping[str, Any], b: Mapping[str, Any]) -> dict[str, tuple[Row, ...]]:
    said = [
        Row("verdict", str(a["verdict"]), str(b["verdict"]), a["verdict"] != b["verdict"]),
        Row("confidence", f"{a['confidence']:.2f}", f"{b['confidence']:.2f}"),
        Row("input", a["input_hash"][:12], b["input_hash"][:12], a["input_hash"] != b["input_hash"]),
        Row("spacerobot", a["spacerobot"], b["spacerobot"], a["spacerobot"] != b["spacerobot"]),
    ]
    one, two = ((v["held_out"] or {}).get("overall") or {} for v in (a, b))
    held = [
        Row(f"all channels, {what}", number(one.get(key)), number(two.get(key)))
        for what, key in (("before", "rms_before"), ("after", "rms_after"))
    ]
    one, two = ((v["held_out"] or {}).get("channels") or {} for v in (a, b))
    for name in dict.fromkeys([*one, *two]):
        unit = unit_of_channel(name)
        after = [quantity((c.get(name) or {}).get("rms_after"), unit) for c in (one, two)]
        held.append(Row(f"{name}, after{'' if unit else ', SI'}", after[0], after[1]))
    return {
        "Verdict": tuple(said),
        "Effects": tuple(_values(_of_effects(a), _of_effects(b))),
        "Believed values that moved": tuple(_values(dict(a["parameters"]), dict(b["parameters"]))),
        "Every believed value, fitted": tuple(_moved(a.get("moved") or {}, b.get("moved") or {})),
        "Held-out error": tuple(held),
        "Smallest effects that these data would show": tuple(_limits(a["detectable"], b["detectable"])),
    }


def _of_effects(verdict: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    found: dict[str, Mapping[str, Any]] = {}
    for e in verdict["effects"]:
        for name, p in e["parameters"].items() or [("", {})]:
            part = f"{e['part']}: " if "part" in e and not str(e["where"]).endswith(str(e["part"])) else ""
            alone = f", in trial {' and '.join(map(str, e['trials']))}" if e.get("trials") else ""
            found[f"{part}{effect_phrase(e)}: {parameter_label(name)}{alone}"] = p
    return found


def _values(a: Mapping[str, Mapping[str, Any]], b: Mapping[str, Mapping[str, Any]]) -> list[Row]:
    def text(p: Mapping[str, Any] | None) -> str:
        return "–" if p is None else quantity(p.get("value"), p.get("unit"), p.get("ci95"))

    names = dict.fromkeys([*a, *b])
    return [Row(n, text(a.get(n)), text(b.get(n)), _apart(a.get(n), b.get(n))) for n in names]


def _apart(a: Mapping[str, Any] | None, b: Mapping[str, Any] | None) -> bool | None:
    """Whether two intervals miss each other; True where one run lacks the value, None where no interval is known."""
    if a is None or b is None:
        return True
    ends = [[finite(x) for x in p.get("ci95") or (None, None)] for p in (a, b)]
    if any(x is None for pair in ends for x in pair):
        return None
    (low, high), (other_low, other_high) = ((min(p), max(p)) for p in ends)  # type: ignore[type-var]
    return bool(high < other_low or other_high < low)  # type: ignore[operator]


def _moved(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[Row]:
    def text(name: str, found: Mapping[str, Any] | None) -> str:
        if found is None:
            return "held exact, or absent"
        return (
            f"{quantity(found['value'], found.get('unit') or unit_of_value(name))} ({number(found['in_sigmas'], 2)} σ)"
        )

    return [Row(n, text(n, a.get(n)), text(n, b.get(n))) for n in dict.fromkeys([*a, *b])]


def _limits(a: Sequence[Mapping[str, Any]], b: Sequence[Mapping[str, Any]]) -> list[Row]:
    def by_name(items: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
        return {f"{effect_phrase(d)}: {parameter_label(str(d['parameter']))}": d for d in items}

    def text(d: Mapping[str, Any] | None) -> str:
        return "–" if d is None else "not visible" if beyond(d) else quantity(d["smallest"], d["unit"])

    one, two = by_name(a), by_name(b)
    return [Row(n, text(one.get(n)), text(two.get(n))) for n in dict.fromkeys([*one, *two])]


def _overlays(a: Mapping[str, Any], b: Mapping[str, Any]) -> tuple[Row, ...]:
    def text(c: Mapping[str, Any] | None) -> str:
        return "–" if c is None else f"{quantity(c['rms'], c['unit'])} ({number(c['rms_sigmas'])} σ)"

    one, two = a["channels"], b["channels"]
    return tuple(Row(n, text(one.get(n)), text(two.get(n))) for n in dict.fromkeys([*one, *two]))


def _pictures(first: Path, second: Path) -> tuple[tuple[str, str, str], ...]:
    def found(folder: Path) -> dict[str, Path]:
        every = [*sorted(folder.glob("plots/*.svg")), *sorted(folder.glob("trial_*.png"))]
        return {p.name: p for p in every if p.is_file() and not p.is_symlink()}

    one, two = found(first), found(second)
    return tuple((n, _uri(one[n]), _uri(two[n])) for n in [n for n in one if n in two][:PICTURES])


def _uri(path: Path) -> str:
    kind = "svg+xml" if path.suffix == ".svg" else "png"
    return f"data:image/{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"
