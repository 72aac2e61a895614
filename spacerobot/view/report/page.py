"""The page of a diagnosis: what the template is given, and the policy that keeps the page to itself."""

from __future__ import annotations

import base64
import hashlib
import math
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from spacerobot.recordings.value_units import unit_of_value
from spacerobot.view.report import charts, words
from spacerobot.view.report.evidence import Evidence, Trace
from spacerobot.view.report.formula import mathml
from spacerobot.view.report.story import capital, change_text, confidence_text, few_trials, improvement, tell
from spacerobot.view.report.traces_json import embedded
from spacerobot.view.report.unseen import unseen
from spacerobot.view.report.words import finite, of_body, per_unit, rivals_with_own_units, with_own_units

RIVALS = 200
"""Screened hypotheses listed one by one; the others are counted."""

UNEXPLAINED = ("unknown", "not_trusted")
"""Verdicts with no model to show: only what the baseline leaves over."""

_SCRIPTS = ("uplot/uPlot.iife.min.js", "page.js", "explorer.js")
_STYLES = ("uplot/uPlot.min.css", "page.css")


def page(verdict: Mapping[str, Any], evidence: Evidence) -> str:
    """The page as HTML text.

    Args:
        verdict: as in verdict.json, plain JSON values.
        evidence: the rest, read.
    """
    verdict = per_unit(with_own_units(of_body(verdict, evidence.body), evidence.channels))
    evidence = evidence.with_body()
    if verdict["verdict"] in UNEXPLAINED:
        evidence = evidence.without_after()
    data, kept = embedded(evidence.traces)
    scripts, styles = assets()
    hero = _hero(verdict, evidence)
    fitted, screened, more = _rivals(
        _with_held_out(verdict, rivals_with_own_units(evidence.hypotheses, evidence.channels))
    )
    scored = any(finite(h.get("held_out")) is not None for h in evidence.hypotheses)
    fitted, untold = _told(fitted) if not scored else (fitted, [])
    unit = " σ" if (verdict.get("held_out") or {}).get("unit", "sigma") == "sigma" else ""
    surfaces = [(s, charts.surface_chart(s).inline()) for s in evidence.surfaces[:24]]
    template = _environment().get_template("page.html")
    return template.render(
        v=verdict,
        e=evidence,
        story=tell(verdict, evidence),
        few=few_trials(len(evidence.trials)),
        nothing_chosen=verdict["verdict"] in UNEXPLAINED,
        gained=improvement(verdict),
        confidence=confidence_text(verdict),
        overall=(verdict.get("held_out") or {}).get("overall") or {},
        channels=(verdict.get("held_out") or {}).get("channels") or {},
        scheme=(verdict.get("held_out") or {}).get("scheme"),
        unseen=unseen(verdict),
        hero=hero,
        hero_chart=charts.traces_chart([hero]).inline("hero") if hero is not None else None,
        static=[(t, charts.traces_chart([t]).inline()) for t in _one_a_channel(evidence)],
        located=evidence.located or verdict["located"],
        surfaces=surfaces,
        formulas=_formulas(verdict, evidence),
        improvement_chart=_inline(charts.improvement_chart(_overall(verdict), unit)),
        unit=unit,
        rivals_chart=_inline(charts.rivals_chart(evidence.hypotheses)),
        fitted=fitted,
        untold=untold,
        screened=screened,
        more_screened=more,
        scored=scored,
        best=_best(evidence.hypotheses),
        laws=[_drawn(law) for law in verdict.get("learned", ())],
        parameter_charts={k: _inline(charts.parameter_chart(k, p)) for k, p in verdict["parameters"].items()},
        data=Markup(data),  # noqa: S704 - JSON with every bracket escaped
        kept=kept,
        scripts=scripts,
        styles=styles,
        policy=policy(scripts, styles),
    )


@cache
def _environment() -> Environment:
    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        loader=PackageLoader("spacerobot.view.report", "templates"),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    for function in (
        words.number, words.quantity, words.percent, words.probability, words.effects_phrase, words.effect_phrase,
        words.parameter_label, words.parameters_text, words.unit_text, words.effect_title, words.place, words.finite,
        unit_of_value, words.beyond,
        change_text, capital,
    ):  # fmt: skip
        environment.filters[function.__name__] = function
    environment.filters["clip"] = _clip
    return environment


def _clip(text: object, limit: int = 400) -> str:
    """A text of bounded length; what a file says of itself may be of any."""
    said = str(text)
    return said if len(said) <= limit else said[: limit - 1] + "…"


@cache
def assets() -> tuple[tuple[Markup, ...], tuple[Markup, ...]]:
    """Scripts and styles of pages with an explorer of traces."""
    folder = files("spacerobot.view.report").joinpath("assets")

    def read(name: str) -> Markup:
        return Markup(folder.joinpath(name).read_text(encoding="utf-8").strip())  # noqa: S704 - files of this package

    return tuple(read(n) for n in _SCRIPTS), tuple(read(n) for n in _STYLES)


def policy(scripts: Sequence[str], styles: Sequence[str]) -> str:
    """A content security policy that lets these scripts and styles run, and nothing else load or run at all."""

    def sources(texts: Sequence[str]) -> str:
        digests = (base64.b64encode(hashlib.sha256(str(t).encode()).digest()).decode() for t in texts)
        return " ".join(f"'sha256-{d}'" for d in digests)

    return (
        f"default-src 'none'; script-src {sources(scripts)}; style-src {sources(styles)}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def _inline(chart: charts.Chart | None) -> Markup | None:
    return chart.inline() if chart is not None else None


def _drawn(law: Mapping[str, Any]) -> tuple[Mapping[str, Any], Markup | None, Markup, Markup]:
    """A learned law, its formula, how its curve acts, and the curve."""
    return law, mathml(law["formula"]) if law["formula"] else None, mathml(law["law"]), charts.law_chart(law).inline()


def _hero(verdict: Mapping[str, Any], evidence: Evidence) -> Trace | None:
    """The trace of the first screen: where the verdict shows best."""
    shown = evidence.shown
    if not shown:
        return None
    if verdict["verdict"] in ("unknown", "not_trusted"):
        return max(shown, key=lambda t: t.rms("after") or t.rms("before") or 0.0)
    read = [t for t in shown if _read_by(t, verdict["effects"], evidence)]
    return max(read or shown, key=lambda t: t.gain)


def _read_by(trace: Trace, effects: Sequence[Mapping[str, Any]], evidence: Evidence) -> bool:
    """Whether the trace is of a sensor that the verdict, being about sensors alone, names."""
    if not effects or not all(words.is_sensor(str(e["effect"])) for e in effects):
        return False
    stream = str((evidence.channels.get(trace.channel) or {}).get("stream"))
    force = "force" in trace.channel or "torque" in trace.channel
    return any(e["where"] in (stream, "force_sensor" if force else "mocap") for e in effects)


def _one_a_channel(evidence: Evidence) -> list[Trace]:
    """For print and for readers without scripts: of every channel the trace in which the models differ most."""
    best: dict[str, Trace] = {}
    for trace in evidence.shown:
        if trace.channel not in best or trace.gain > best[trace.channel].gain:
            best[trace.channel] = trace
    return list(best.values())[:12]


def _formulas(verdict: Mapping[str, Any], evidence: Evidence) -> dict[tuple[str, str], dict[str, Any]]:
    """(effect, where) -> its formula in MathML, title and source."""
    found = {}
    for item in evidence.formulas:
        key = (str(item.get("effect", "")), str(item.get("where", "")))
        found[key] = {
            "title": item.get("title") or words.effect_title(key[0]),
            "formula": mathml(str(item.get("latex") or "")) if item.get("latex") else None,
            "source": item.get("source"),
        }
    return found


def _best(hypotheses: Sequence[Mapping[str, Any]]) -> float | None:
    values = [finite(h.get("chi2")) for h in hypotheses if h.get("stage") == "fitted"]
    known = [v for v in values if v is not None and math.isfinite(v)]
    return min(known) if known else None


def _overall(verdict: Mapping[str, Any]) -> dict[str, Any]:
    """The held-out errors, without those of a second model where none is named."""
    found = dict((verdict.get("held_out") or {}).get("overall") or {})
    if verdict["verdict"] in UNEXPLAINED:
        found.pop("rms_after", None)
    return found


def _with_held_out(verdict: Mapping[str, Any], hypotheses: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The hypotheses, the winner marked, each with what unseen trials say of it.

    Those two that predicted all of them have their error there; another its error ("folds") over the parts of the
    trials without which it was the choice, and how many of how many these were.
    """
    folds = (verdict.get("held_out") or {}).get("folds") or ()
    overall = (verdict.get("held_out") or {}).get("overall") or {}
    named = sorted((str(e["effect"]), str(e["where"])) for e in verdict["effects"])
    out = []
    for h in hypotheses:
        effects = sorted((str(e["effect"]), str(e["where"])) for e in h.get("effects") or ())
        fitted = h.get("stage") == "fitted"
        won = bool(h["chosen"]) if "chosen" in h else fitted and effects == named and not h.get("lost")
        error = h.get("unseen")
        if won or (fitted and not effects):
            error = overall.get("rms_after" if won else "rms_before")
        picked = [f for f in folds if f.get("part", "") == (h.get("part") or f.get("part", "")) and _set(f) == effects]
        chosen = won and verdict["verdict"] not in UNEXPLAINED
        out.append({**h, "chosen": chosen, "unseen": error, "folds": _folds(picked, len(folds)) if fitted else None})
    return out


def _told(fitted: Sequence[Mapping[str, Any]]) -> tuple[list[Mapping[str, Any]], list[Mapping[str, Any]]]:
    """Those of which unseen trials say something, and the others; all are told where of none anything is known."""
    known = [h for h in fitted if h["unseen"] is not None or (h["folds"] or {}).get("error") is not None]
    return (known, [h for h in fitted if h not in known]) if known else ([*fitted], [])


def _set(fold: Mapping[str, Any]) -> list[tuple[str, str]]:
    return sorted((str(e["effect"]), str(e["where"])) for e in fold["selected"])


def _folds(picked: Sequence[Mapping[str, Any]], count: int) -> dict[str, Any] | None:
    """Root mean square error over the folds that chose a set, and how many they are; None where none did."""
    errors = [finite(f.get("rms_selected")) for f in picked]
    known = [e for e in errors if e is not None and math.isfinite(e)]
    if not picked:
        return None
    error = math.sqrt(sum(e * e for e in known) / len(known)) if known else None
    return {"picked": len(picked), "of": count, "error": error}


def _rivals(
    hypotheses: Sequence[Mapping[str, Any]],
) -> tuple[list[Mapping[str, Any]], list[Mapping[str, Any]], int]:
    """Fitted and screened hypotheses, best first, and how many screened ones are only counted."""

    def rank(item: Mapping[str, Any]) -> tuple[bool, float, float]:
        score, chi2 = finite(item.get("held_out")), finite(item.get("chi2"))
        kept = not item.get("chosen")
        return (kept, -score if score is not None else math.inf, chi2 if chi2 is not None else math.inf)

    fitted = sorted((h for h in hypotheses if h.get("stage") == "fitted"), key=rank)
    screened = sorted((h for h in hypotheses if h.get("stage") != "fitted"), key=rank)
    return fitted[:RIVALS], screened[:RIVALS], max(len(screened) - RIVALS, 0) + max(len(fitted) - RIVALS, 0)
