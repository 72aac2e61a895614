"""The catalogue of effects, from the registry."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from spacerobot.effects.effect import Effect, Parameter
from spacerobot.effects.mechanism import Mechanism
from spacerobot.effects.primitives import Coordinate, Readout
from spacerobot.effects.registry import all_effects
from spacerobot.proof.proved import proved
from spacerobot.simulation.parts import Target
from spacerobot.simulation.scene import Scene
from spacerobot.view.report.words import effect_title

_KINDS = {
    "force": "Forces",
    "body": "Bodies",
    "gravity": "Gravity",
    "contact": "Contact",
    "sensor": "Sensors",
}


def effects() -> str:
    """Every effect: formula, ports, parameters with units and bounds, source, and where the proof hides it."""
    lines = []
    found = all_effects().values()
    known = [*_KINDS, *sorted({e.kind for e in found} - set(_KINDS))]
    for kind in known:
        of_kind = [e for e in found if e.kind == kind]
        if of_kind:
            lines += [f"## {_KINDS.get(kind, kind.capitalize())}", ""]
        for one in sorted(of_kind, key=lambda e: e.name):
            lines += _entry(one)
    return "\n".join(lines)


def entry(one: Effect) -> dict[str, Any]:
    """One effect ready for JSON: kind, places, parameters with units and bounds, formula, source, proofs."""
    return {
        "effect": one.name,
        "title": effect_title(one.name),
        "kind": one.kind,
        "where": list(ports(one)),
        "parameters": {
            p.name: {"unit": p.unit, "null": p.null, "lower": p.lower, "upper": p.upper} for p in one.parameters
        },
        "formula": one.formula,
        "source": one.source,
        "replaces": list(one.replaced("PORT")) if one.replaces else [],
        "forms": list(one.forms),
        "proved": list(proved().get(one.name, ())),
    }


def _entry(one: Effect) -> list[str]:
    where = ", ".join(f"`{place}`" for place in ports(one)) or "where a study has the port"
    lines = [
        f"### `{one.name}`",
        "",
        f"{effect_title(one.name).capitalize()}, at {where}.",
        "",
        f"$${one.formula}$$",
        "",
        "| parameter | unit | nothing at | from | to |",
        "|---|---|---|---|---|",
        *(_row(p) for p in one.parameters),
        "",
    ]
    if one.replaces:
        taken = ", ".join(f"`{name}`" for name in one.replaced("PORT"))
        lines += [f"Takes over from {taken}, which is refitted freely.", ""]
    if one.forms:
        forms = ", ".join(f"`{one.name}~{form}`" for form in one.forms)
        first = one.in_form(one.forms[0])
        stated = " and ".join(f"`{key}`" for key in first.settings)
        more = [f"`{p.name}` ({p.unit})" for p in first.parameters if p.name not in {q.name for q in one.parameters}]
        plural = "s" if len(one.forms) > 1 else ""
        besides = f" It has {' and '.join(more)} as well: ${first.formula}$." if more else ""
        lines += [f"Also in the form{plural} {forms}; a scene may state {stated} instead.{besides}", ""]
    hidden = proved().get(one.name, ())
    shown = f"Proved at {', '.join(f'`{place}`' for place in hidden)}." if hidden else "Not yet proved."
    return [*lines, f"Source: {one.source}. {shown}", ""]


def _row(p: Parameter) -> str:
    return f"| `{p.name}` | {p.unit} | {_number(p.null)} | {_number(p.lower)} | {_number(p.upper)} |"


def _number(value: float) -> str:
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return f"{value:g}".replace("-", "−")


def ports(one: Effect) -> tuple[str, ...]:
    """Where it can sit in a capture on the ground or in orbit, or at a joint alone; joints count as one."""
    found: dict[str, None] = {}
    for mechanism in _mechanisms():
        for place in one.places(mechanism):
            head = place.partition(".")[0]
            found[f"{head}.NAME" if head in ("joint", "link") else place] = None
    return tuple(found)


@cache
def _mechanisms() -> tuple[Mechanism, ...]:
    turned, joint = Target(contact_point=(0.15, 0.01)), "joint.axis"
    return (
        Scene(target=turned, backend="reduced").mechanism(),
        Scene("chaser_pa10_wrist", base="free", joints="free", approach=(-1.0, 0.0, 0.0), target=turned).mechanism(),
        Mechanism(
            coordinates={joint: Coordinate(joint, 1.0, angular=True)},
            ports={joint: {joint: 1.0}},
            readouts={f"{joint}.position": Readout(f"{joint}.position", "position", joint)},
        ),
    )
