"""A page with one row a study: the verdict, what is named with its values, and how much better unseen data are met."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

from spacerobot.view.report.when import happened
from spacerobot.view.report.words import effect_title, number, of_body, place, quantity
from spacerobot.view.table.beside import beside

LISTED = 3
"""Sets between which nothing decides, at most."""

INTRO = """\
# Real recordings

What `spacerobot diagnose` says of public recordings of real hardware, with the same settings for all of them. The
studies are described in `examples/studies/real/`; the recordings are not part of this project and are read from the
folder that `SPACEROBOT_DATA` names. This page is written by

```sh
make real-table
```

Held-out errors are root mean squares over data that the fit had not seen. In this table they are in units of the stated
sensor noise (σ) where every channel's is stated, else shares of each channel's own spread; below, by channel, in SI
units.
"""


def page(verdicts: Mapping[str, Mapping[str, Any]], absent: Sequence[str] = ()) -> str:
    """The page as Markdown.

    Args:
        verdicts: verdict.json by name of the study.
        absent: studies whose recordings are not here.
    """
    verdicts, absent = _as_text(verdicts), _as_text(absent)
    rows = [
        "| study | verdict | what the baseline lacks | held out, before | after | CPU |",
        "|---|---|---|---|---|---|",
    ]
    rows += [_row(name, verdict) for name, verdict in verdicts.items()]
    parts = [INTRO, "\n".join(rows), ""]
    parts += beside(verdicts)
    for name, verdict in verdicts.items():
        parts += [f"## {name}", "", f"{verdict['study']}.", "", *_details(verdict)]
    if absent:
        parts += [f"Not here when this was written: {', '.join(absent)}.", ""]
    return "\n".join(parts)


def _as_text(value: Any) -> Any:
    """The same with every text in it safe in Markdown, where HTML and columns would count: studies are of strangers."""
    if isinstance(value, str):
        return escape(value, quote=False).replace("|", "&#124;")
    if isinstance(value, Mapping):
        return {_as_text(k): _as_text(v) for k, v in value.items()}
    return [_as_text(v) for v in value] if isinstance(value, list | tuple) else value


def _row(name: str, verdict: Mapping[str, Any]) -> str:
    overall = verdict["held_out"]["overall"]
    unit = " σ" if verdict["held_out"].get("unit", "sigma") == "sigma" else ""
    said = verdict["verdict"].replace("_", " ")
    named = _titles(e["effect"] for e in verdict["effects"])
    if not named and verdict["verdict"] == "ambiguous":
        named = _one_of([[(e["effect"], e["where"]) for e in a["effects"]] for a in verdict["alternatives"][:LISTED]])
    before, after = (f"{number(overall[k])}{unit}" for k in ("rms_before", "rms_after"))
    seconds = verdict.get("cpu_seconds")
    return f"| [{name}](#{name}) | {said} | {', '.join(named)} | {before} | {after} | {number(seconds, 2)} s |"


def _titles(effects: Iterable[object]) -> list[str]:
    """Each effect once, wherever it is."""
    return list(dict.fromkeys(effect_title(str(e)) for e in effects))


def _one_of(sets: Sequence[Sequence[tuple[object, object]]]) -> list[str]:
    """What sets of (effect, where) have in common, and last in what they differ, where they do."""
    shared = [one for one in sets[0] if all(one in other for other in sets)] if sets else []
    differ = [_titles(effect for effect, where in one if (effect, where) not in shared) for one in sets]
    either = " or ".join(" + ".join(titles) or "nothing more" for titles in differ)
    return [*_titles(effect for effect, _ in shared), *([either] if any(differ) else [])]


def _details(verdict: Mapping[str, Any]) -> list[str]:
    lines = []
    mock_up = any(c.startswith("target.") for c in verdict["held_out"]["channels"])
    shown = of_body(verdict, "target" if mock_up else "body")
    for entry in shown["effects"]:
        values = ", ".join(
            f"{key} {quantity(p['value'], p['unit'], p['ci95'])}" for key, p in entry["parameters"].items()
        )
        part = f" of {entry['part']}" if "part" in entry and not str(entry["where"]).endswith(entry["part"]) else ""
        lines.append(f"- {effect_title(str(entry['effect']))} {place(str(entry['where']))}{part}: {values}")
    for name, p in shown["parameters"].items():
        lines.append(
            f"- {name} {quantity(p['value'], p['unit'], p['ci95'])}, believed {quantity(p['believed'], p['unit'])}"
        )
    quiet = [p["part"] for p in verdict.get("parts", []) if p["verdict"] == "nothing_missing"]
    if quiet and len(verdict["parts"]) > 1:
        lines.append(f"- nothing missing: {', '.join(quiet)}")
    for entry in verdict.get("parts", []):
        if entry.get("relative_to") and entry["effects"]:
            names = " and ".join(entry["relative_to"])
            lines.append(f"- forces on {entry['part']} are per unit of its {names}, which is not known")
    lines += [f"- {text}" for text in happened(verdict)]
    lines += ["", "| channel | before | after |", "|---|---|---|"]
    for channel, c in verdict["held_out"]["channels"].items():
        lines.append(f"| {channel} | {number(c['rms_before'])} | {number(c['rms_after'])} |")
    return [*lines, "", f"Held out: {verdict['held_out']['scheme']}.", ""]
