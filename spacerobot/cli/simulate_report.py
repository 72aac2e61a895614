"""The answer of `spacerobot simulate` as text."""

from __future__ import annotations

from typing import Any

from spacerobot.simulation.restitution import POINT_NOTE


def as_text(answer: dict[str, Any]) -> str:
    """A table of predicted and simulated numbers, and what took the energy."""
    simulated, reduced, exact = answer["simulated"], answer["predicted"] or {}, answer["predicted_three_masses"] or {}
    hand, energy = answer["hand"], answer["energy"]
    lines = [
        f"{answer['robot']}, base {answer['base']}, joints {answer['joints']}; backend {answer['backend']}",
        f"hand: effective mass {_mass(hand['effective_mass_kg'])} ({hand['note']})",
        "",
        f"{'':34}{'reduced model':>15}{'Eqs. 2 to 4':>15}{'simulated':>15}",
        _row("contact time [s]", reduced.get("contact_time"), exact.get("contact_time"), simulated["contact_time"]),
        _row("  until the force is zero [s]", reduced.get("contact_time_unilateral"), None, None),
        _row("  summed [s]", None, exact.get("contact_time_summed"), simulated["contact_time_summed"]),
        _row(
            "restitution, target against hand",
            reduced.get("restitution"),
            exact.get("restitution_hand"),
            simulated["hand"],
        ),
        _row("  until the force is zero", reduced.get("restitution_unilateral"), None, None),
        _row("  without equivalent damping", reduced.get("restitution_without_equivalent"), None, None),
        _row("restitution, target alone", None, exact.get("restitution_target"), simulated["target"]),
        _row("restitution, at the contact point", None, None, simulated["point"]),
        *([f"  ({POINT_NOTE})"] if _above_one(simulated["point"]) else []),
        _row("touches", None, exact.get("touches"), simulated["touches"]),
        "",
        _peak(answer),
        "energy taken by: " + (_shares(energy) or "nothing"),
        f"energy ledger closes to {energy['imbalance']:.1e} of the initial {energy['initial_J']:.5g} J",
    ]
    if simulated["target"] is None and simulated["touches"]:
        lines.append("wrist and target still touch at the end: a longer --duration shows the separation")
    lines += [f"note: {text}" for text in answer["notes"]]
    return "\n".join(lines)


def _above_one(value: Any) -> bool:
    return isinstance(value, int | float) and value > 1.0


def _peak(answer: dict[str, Any]) -> str:
    when = answer.get("peak_contact_force_s")
    return f"peak contact force {answer['peak_contact_force_N']:.5g} N" + (
        f" at t = {when:.6g} s" if isinstance(when, float) and when == when else ""
    )


def _row(name: str, *values: Any) -> str:
    return f"{name:34}" + "".join(f"{_number(v):>15}" for v in values)


def _number(value: Any) -> str:
    if value is None:
        return "-"
    return str(value) if isinstance(value, int | str) else f"{value:.6g}" if value == value else "-"


def _mass(value: Any) -> str:
    return "infinite" if value in ("inf", float("inf")) else f"{value:.5g} kg"


def _shares(energy: dict[str, Any]) -> str:
    first = energy["initial_J"] or 1.0
    taken = sorted(energy["dissipated_J"].items(), key=lambda item: -abs(item[1]))
    return ", ".join(f"{name} {100.0 * value / first:.4g} %" for name, value in taken if abs(value) > 1e-9 * first)
