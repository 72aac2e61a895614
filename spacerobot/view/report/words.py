"""How reports speak of effects, places, parameters and numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from spacerobot.effects.one_sided import SIDES
from spacerobot.effects.registry import all_effects

_PLACES = {
    "wrist": "in the wrist's guide",
    "contact": "at the contact",
    "arm": "in the arm",
    "target": "on the target",
    "base": "on the base",
    "body": "on the body",
    "command": "in the commanded force",
    "command.force": "in the commanded force, not in the torque",
    "arm_motion": "in the arm's known motion",
    "force_sensor": "in the force sensor",
    "mocap": "in the position measurement",
}

_UNIT_TOKENS = {"N", "Ns", "Ns2", "Nm", "Nms", "Nms2", "m", "m2", "m3", "s", "s2", "rad", "rad2", "rad3", "kg", "Hz"}

_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")

_SMALL = {"m": (("mm", 1e-3), ("µm", 1e-6)), "s": (("ms", 1e-3), ("µs", 1e-6)), "rad": (("mrad", 1e-3), ("µrad", 1e-6))}

OWN = "channel unit"
"""What the catalogue says of a parameter that is counted as its channel is."""

MISSING = "–"
"""Printed where there is no value."""


def effect_title(name: str) -> str:
    """An effect's few words for people; a name nobody registered is spelt out."""
    known = all_effects().get(name)
    return known.title if known is not None else name.replace("_", " ")


def is_sensor(name: str) -> bool:
    """Whether the effect is a property of a sensor, not of the physics."""
    known = all_effects().get(name)
    return known is not None and known.kind == "sensor"


def place(where: str) -> str:
    """Where an effect sits, as part of a sentence."""
    if where in _PLACES:
        return _PLACES[where]
    if where.startswith("joint."):
        return f"in joint {where.removeprefix('joint.')}"
    if where.startswith("link."):
        return f"on link {where.removeprefix('link.')}"
    if where.startswith("command."):
        _, kind, axis = where.split(".")
        return f"in the commanded {kind} ({axis})"
    head, dot, axis = where.partition(".")
    if dot and head in ("target", "base", "body"):
        return f"{_PLACES[head]} ({axis})"
    return f"in {where}"


def floating(where: str, name: str) -> str:
    """A place or balance with what floats called `name`: "target.y" is "body.y"; others as they are."""
    head, dot, rest = where.rpartition("target")
    return f"{head}{name}{rest}" if dot and (not head or head.endswith(": ")) else where


def of_body(verdict: Mapping[str, Any], name: str = "body") -> dict[str, Any]:
    """The verdict of a study that is diagnosed part by part, with what floats called by its own name.

    Catalogues know whatever floats as the target; a ball that falls has hit nobody.
    """
    out = dict(verdict)
    if "parts" not in verdict or name == "target":
        return out
    for key, field in (("effects", "where"), ("detectable", "where"), ("located", "balance")):
        out[key] = [{**e, field: floating(str(e[field]), name)} for e in verdict[key]]
    if "learned" in verdict:
        out["learned"] = [{**law, "where": floating(str(law["where"]), name)} for law in verdict["learned"]]
    out["alternatives"] = [
        {**a, "effects": [{**e, "where": floating(str(e["where"]), name)} for e in a["effects"]]}
        for a in verdict["alternatives"]
    ]
    return out


def effect_phrase(item: Mapping[str, Any]) -> str:
    """ "Coulomb friction in the wrist's guide"."""
    return f"{effect_title(str(item['effect']))}{_side(item)} {place(str(item['where']))}"


def effect_object(item: Mapping[str, Any]) -> str:
    """The same as the object of a sentence: "a time offset in the force sensor"."""
    known = all_effects().get(str(item["effect"]))
    said = known.phrase or known.title if known is not None else effect_title(str(item["effect"]))
    return f"{said}{_side(item)} {place(str(item['where']))}"


def _side(item: Mapping[str, Any]) -> str:
    """On which side alone it stands, where it does; empty elsewhere."""
    return f" on one side ({item['kind']})" if item.get("kind") in SIDES else ""


def effects_phrase(items: Sequence[Mapping[str, Any]]) -> str:
    """Several effects as one phrase; "nothing more" for none."""
    return joined([effect_phrase(item) for item in items]) if items else "nothing more"


def joined(words: Sequence[str], last: str = "and") -> str:
    """ "a", "a and b", "a, b and c"."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"


def parameter_label(name: str) -> str:
    """A parameter's name without its unit: half_gap_m is "half gap"."""
    *_, last = name.rpartition(".")
    tokens = last.split("_")
    while len(tokens) > 1 and tokens[-1] in _UNIT_TOKENS:
        tokens.pop()
    label = " ".join(tokens)
    owner = name.removesuffix(last).removesuffix(".").replace(".", " ").replace("_", " ")
    return f"{owner} {label}".strip()


def unit_of_name(name: str) -> str:
    """The unit that a name carries as its suffix: speed_m_s has m/s, force_N has N; none for dimensionless ones."""
    tokens = name.rpartition(".")[2].split("_")
    start = len(tokens)
    while start > 1 and tokens[start - 1] in _UNIT_TOKENS:
        start -= 1
    units = [re.sub(r"(\d)$", r"^\1", t).replace("Ns", "N s").replace("Nms", "N m s") for t in tokens[start:]]
    # an inertia is told as a joint's mass is: in kg, which are kg m^2 where it turns
    return "kg" if units == ["kg", "m^2"] else "/".join(units)


def unit_text(unit: str | None) -> str:
    """A unit as printed: N/m^3 is N/m³; none for pure numbers."""
    if not unit or unit in ("1", OWN):
        return ""
    return re.sub(r"\^(-?\d+)", lambda m: m.group(1).translate(_SUPERSCRIPT), unit)


def finite(value: Any) -> float | None:
    """A JSON number as a float ("inf" included); None where there is none."""
    if value is None or isinstance(value, bool):
        return None
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return None if math.isnan(number) else number


def number(value: Any, digits: int = 3) -> str:
    """A number to some significant digits: 0.308, 5.3 × 10⁴, ∞."""
    x = finite(value)
    if x is None:
        return MISSING
    if math.isinf(x):
        return "∞" if x > 0 else "−∞"
    text = f"{x:.{digits}g}"
    if "e" in text and 1.0 <= abs(x) < 1e5:
        text = f"{float(text):.0f}"  # 190, not 1.9 × 10²
    if "e" in text:
        mantissa, exponent = text.split("e")
        text = f"{mantissa} × 10{str(int(exponent)).translate(_SUPERSCRIPT)}"
    elif abs(x) >= 1000 and "." not in text and len(text.lstrip("-")) >= 5:
        text = f"{float(text):,.0f}".replace(",", "\u202f")
    return text.replace("-", "−")


def probability(p: Any) -> str:
    """A p-value: "0.03", or "< 10⁻⁹" where more digits mean nothing."""
    x = finite(p)
    if x is None:
        return MISSING
    if x < 1e-9:
        return "< 10⁻⁹"
    if x < 1e-3:
        return f"10{str(round(math.log10(x))).translate(_SUPERSCRIPT)}"
    return number(x, 2)


def percent(share: Any, digits: int = 0) -> str:
    """A share of one as per cent; to so many significant digits, or whole ones for none."""
    x = finite(share)
    if x is None:
        return MISSING
    return f"{number(100.0 * x, digits)} %" if digits else f"{100.0 * x:.0f} %"


def _scaled(size: float, unit: str | None) -> tuple[str, float]:
    """Name and size of the unit in which a value of this size reads best."""
    small = _SMALL.get(unit or "")
    if small is None or not 0.0 < size < 0.1:
        return unit_text(unit), 1.0
    return small[0] if size >= 1e-4 else small[1]


def _decimals(values: Sequence[float], width: float) -> str:
    """Format so that the width of the interval shows two digits."""
    if not (width > 0.0 and math.isfinite(width)):
        return ".3g"
    places = 1 - math.floor(math.log10(width))
    if places > 6 or max(abs(v) for v in values) >= 1e6:
        return ".4g"
    return f".{max(places, 0)}f"


def quantity(value: Any, unit: str | None, ci95: Any = None) -> str:
    """A value with its unit and 95 % interval: "0.308 N (95 %: 0.291 to 0.325)".

    Lengths, times and angles are put into milli or micro units where that reads better.
    """
    x = finite(value)
    if x is None:
        return MISSING
    label, factor = _scaled(abs(x), unit)
    low, high = (finite(v) for v in ci95) if ci95 is not None and len(ci95) == 2 else (None, None)
    tail = f"\u00a0{label}" if label else ""
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high) and math.isfinite(x)):
        text = f"{number(x / factor)}{tail}"
        return (
            text
            if low is None or high is None
            else f"{text} (95\u00a0%: {number(low / factor)} to {number(high / factor)})"
        )
    values = [x / factor, low / factor, high / factor]
    spec = _decimals(values, (high - low) / factor)
    texts = [number(v, 4) if "g" in spec else f"{v:{spec}}".replace("-", "−") for v in values]
    return f"{texts[0]}{tail} (95\u00a0%: {texts[1]} to {texts[2]})"


def parameters_text(parameters: Mapping[str, Any]) -> str:
    """All parameters of an effect in one line; keys "effect@where.parameter" by effect, where there are several."""
    owners: dict[str, list[str]] = {}
    for key, item in parameters.items():
        owner, _, name = key.rpartition(".") if "@" in key else ("", "", key)
        if isinstance(item, Mapping):
            text = quantity(item.get("value"), item.get("unit"), item.get("ci95"))
        else:  # a joint that turns has its torques under the names of forces
            text = quantity(item, unit_of_name(name) if owner and "@joint." not in owner else None)
        owners.setdefault(owner, []).append(text if len(parameters) == 1 else f"{parameter_label(name)} {text}")
    return "; ".join(f"{_owner(owner) if len(owners) > 1 else ''}{', '.join(texts)}" for owner, texts in owners.items())


def _owner(key: str) -> str:
    effect, _, where = key.partition("@")
    return f"{effect_title(effect)} {place(where)}: " if where else ""


def with_own_units(verdict: Mapping[str, Any], channels: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """The verdict with the channels' own units where the catalogue only says that there is one.

    Args:
        verdict: as in verdict.json.
        channels: of the study, with unit and stream; as evidence has them.
    """

    def own(item: Mapping[str, Any], where: str) -> dict[str, Any]:
        out = dict(item)
        if out.get("unit") == OWN:
            out["unit"] = _own_unit(where, channels)
        if "parameters" in out:
            values = out["parameters"].items()
            out["parameters"] = {k: own(p, where) if isinstance(p, Mapping) else p for k, p in values}
        return out

    parts = [{**p, "effects": [own(e, str(e["where"])) for e in p["effects"]]} for p in verdict.get("parts") or ()]
    return {
        **verdict,
        **({"parts": parts} if "parts" in verdict else {}),
        "effects": [own(e, str(e["where"])) for e in verdict["effects"]],
        "detectable": [own(d, str(d["where"])) for d in verdict["detectable"]],
        "alternatives": [
            {**a, "effects": [own(e, str(e["where"])) for e in a["effects"]]} for a in verdict["alternatives"]
        ],
    }


def _own_unit(where: str, channels: Mapping[str, Mapping[str, Any]]) -> str:
    here = {str(c.get("unit") or "") for c in channels.values() if c.get("stream") == where}
    kinds = {"force_sensor": "N", "mocap": "m", "command": "N"}
    if where.startswith("command."):
        return "N m" if where.startswith("command.torque.") else "N"
    return kinds.get(where) or (here.pop() if len(here) == 1 else "")


def rivals_with_own_units(
    hypotheses: Sequence[Mapping[str, Any]], channels: Mapping[str, Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """The same for what else was tried: a bias of a stream has the unit of what it reads.

    Args:
        hypotheses: each with its parameters by "effect@where.name"; as evidence has them.
        channels: of the study, with unit and stream.
    """
    known = {(e.name, p.name): p.unit for e in all_effects().values() for p in e.parameters}

    def own(key: str, value: Any) -> Any:
        effect, _, rest = key.partition("@")
        where, _, name = rest.rpartition(".")
        found = known.get((effect, name)) == OWN and not isinstance(value, Mapping)
        return {"value": value, "unit": _own_unit(where, channels)} if found else value

    return [{**h, "parameters": {k: own(k, v) for k, v in (h.get("parameters") or {}).items()}} for h in hypotheses]


def beyond(item: Mapping[str, Any]) -> bool:
    """Whether a smallest detectable size is larger than any the catalogue allows: such data do not show the effect."""
    size, known = finite(item.get("smallest")), all_effects().get(str(item.get("effect")))
    if size is None or math.isinf(size):
        return True
    bounds = [(p.lower, p.upper) for p in known.parameters if p.name == item.get("parameter")] if known else []
    return any(abs(size) >= max(abs(low), abs(high)) for low, high in bounds)


def per_unit(verdict: Mapping[str, Any]) -> dict[str, Any]:
    """The verdict with "per kg" at the forces on bodies whose mass nobody knows: only their ratio to it was told.

    Torques about a body whose yaw inertia is not known are per kg m^2.
    """
    parts = verdict.get("parts") or ()
    relative = {str(p["part"]): tuple(p.get("relative_to") or ()) for p in parts}

    def of(item: Mapping[str, Any], part: str) -> dict[str, Any]:
        where = str(item["where"])
        turning = where.endswith(".yaw")
        names = [n for n in relative.get(part, ()) if n.endswith("yaw_inertia") == turning]
        if not names:
            return dict(item)
        per = " per kg m^2" if turning else " per kg"
        out = dict(item)
        if "unit" in out and _grows_with_mass(out["unit"]):
            out["unit"] += per
        if "parameters" in out:
            out["parameters"] = {
                k: {**p, "unit": p["unit"] + per} if isinstance(p, Mapping) and _grows_with_mass(p["unit"]) else p
                for k, p in out["parameters"].items()
            }
        return out

    def owner(item: Mapping[str, Any]) -> str:
        alone = next(iter(relative)) if len(relative) == 1 else str(item["where"]).partition(".")[0]
        return str(item.get("part") or alone)

    out = {k: [of(e, owner(e)) for e in verdict[k]] for k in ("effects", "detectable")}
    sets = [_set_per_unit(a, of, owner) for a in verdict.get("alternatives") or ()]
    if "learned" in verdict:
        out["learned"] = [_law_per_unit(law, of, owner(law)) for law in verdict["learned"]]
    return {**verdict, **out, "alternatives": sets}


def _law_per_unit(law: Mapping[str, Any], of: Callable[..., dict[str, Any]], owner: str) -> dict[str, Any]:
    """A learned law in such units, its table with it."""
    force = of({"where": law["where"], "unit": law["table"]["value_unit"]}, owner)["unit"]
    return {**of(law, owner), "table": {**law["table"], "value_unit": force}}


def _set_per_unit(
    one: Mapping[str, Any], of: Callable[..., dict[str, Any]], owner: Callable[..., str]
) -> dict[str, Any]:
    """An alternative in such units; its own parameters, "effect@where.name", are numbers in the unit of the name."""
    from spacerobot.diagnosis.answer.turning import turning_unit

    parts = str(one.get("part") or "").split(", ")
    mine = {"part": parts[0]} if len(parts) == 1 and parts[0] else {}

    def measured(key: str, value: Any) -> Any:
        place, _, name = key.rpartition(".")
        unit = None if isinstance(value, Mapping) or "@" not in place else unit_of_name(name)
        if not unit:
            return value
        where = place.partition("@")[2]
        plain = {"where": where, "unit": turning_unit(unit) if where.endswith(".yaw") else unit, **mine}
        now = of(plain, owner(plain))["unit"]
        return value if now == unit else {"value": value, "unit": now}

    values = {k: measured(k, v) for k, v in (one.get("parameters") or {}).items()}
    effects = [of({**mine, **e}, owner({**mine, **e})) for e in one["effects"]]
    return {**one, "effects": effects, **({"parameters": values} if "parameters" in one else {})}


def _grows_with_mass(unit: str) -> bool:
    """Whether a unit has a force or a mass above its line."""
    return bool(re.search(r"\bN|\bkg", unit.partition("/")[0]))
