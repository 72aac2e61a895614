"""The answer of `spacerobot mass` as a JSON object and as text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from spacerobot.dynamics.apparent_mass import ApparentMass
from spacerobot.dynamics.effective_mass import EffectiveMass
from spacerobot.dynamics.impact import Impact, matching_mass
from spacerobot.dynamics.operational import along, reciprocal


def as_json(
    result: EffectiveMass, chain: Sequence[str], notes: Sequence[str] = (), impact: Impact | None = None
) -> dict[str, Any]:
    """The answer; SI, world axes, linear before angular. Infinity becomes "inf" when it is written."""
    n = result.direction
    split = result.split
    ellipsoid = result.ellipsoid
    return {
        "robot": result.robot,
        "frame": result.frame,
        "joint_names": list(chain),
        "q_rad": result.q_rad,
        "direction": n,
        "base": result.base,
        "joints": result.joints,
        "slider": result.slider,
        "effective_mass_kg": result.effective_mass_kg,
        "mobility_per_kg": result.mobility_per_kg,
        "rotational_inertia_kg_m2": result.rotational_inertia_kg_m2,
        "apparent_mass": _apparent(result),
        "split": {
            "mobility_per_kg": result.share(),
            "joints_free_kg": reciprocal(along(split.free[:3, :3], n)),
            "joints_locked_kg": reciprocal(along(split.locked[:3, :3], n)),
        },
        "mobility": _matrix(result.mobility),
        "operational_inertia_3x3": _matrix(result.lambda_linear),
        "operational_inertia_6x6": _matrix(result.lambda_spatial),
        "generalized_jacobian": split.jacobian,
        "belted_ellipsoid": None
        if ellipsoid is None
        else {"principal_masses_kg": ellipsoid.principal_masses, "axes": ellipsoid.axes.T},
        "base_velocity_per_impulse": result.base_velocity_per_impulse,
        "manipulability": result.manipulability,
        "impact": None if impact is None else _impact(impact),
        "notes": [*notes, *result.notes],
        "warnings": list(result.warnings),
    }


def as_text(answer: dict[str, Any], turning: Sequence[bool]) -> str:
    """The same for a reader at a terminal.

    Args:
        answer: what `as_json` made.
        turning: for every joint of the chain whether its position is an angle.
    """
    pose = [
        f"{name} {math.degrees(x):.4g} deg" if angle else f"{name} {x:.4g} m"
        for name, x, angle in zip(answer["joint_names"], answer["q_rad"], turning, strict=True)
    ]
    held = f"base {answer['base']}, joints {answer['joints']}"
    if answer["slider"] is not None:
        held += f", wrist slider {answer['slider']}"
    rows: list[tuple[str, float | None, str]] = [
        ("effective mass", answer["effective_mass_kg"], "kg"),
        ("  mobility", answer["mobility_per_kg"], "1/kg"),
    ]
    if answer["apparent_mass"] is not None:
        rows.append(("  phase", math.degrees(answer["apparent_mass"]["phase_rad"]), "deg"))
        rows.append(("  at", answer["apparent_mass"]["frequency_Hz"], "Hz"))
    split = answer["split"]
    rows += [
        ("rotational inertia", answer["rotational_inertia_kg_m2"], "kg m^2, about the direction"),
        ("joints free", split["joints_free_kg"], "kg"),
        ("joints locked", split["joints_locked_kg"], "kg"),
    ]
    total = split["mobility_per_kg"]["free"]
    rows += [
        (f"  share of the {part}", 100.0 * split["mobility_per_kg"][part] / total, "% of the mobility")
        for part in ("slider", "base", "arm")
        if total > 0.0 and (part != "slider" or answer["slider"] is not None)
    ]
    if answer["belted_ellipsoid"] is not None:
        for mass, axis in zip(
            answer["belted_ellipsoid"]["principal_masses_kg"], answer["belted_ellipsoid"]["axes"], strict=True
        ):
            rows.append(("principal mass", mass, f"kg, along ({', '.join(f'{x:.3f}' for x in axis + 0.0)})"))
    if answer["base"] == "free":
        reaction = float(np.linalg.norm(answer["base_velocity_per_impulse"][:3]))
        turn = float(np.linalg.norm(answer["base_velocity_per_impulse"][3:]))
        rows.append(("base reaction", reaction, "m/s per N s"))
        rows.append(("", turn, "rad/s per N s"))
    rows.append(("manipulability", answer["manipulability"]["dynamic_linear"], "dynamic, linear rows"))
    if answer["impact"] is not None:
        rows += [
            ("impulse of the impact", answer["impact"]["impulse_Ns"], "N s"),
            ("reduced mass", answer["impact"]["reduced_mass_kg"], "kg"),
            ("mass that would match", answer["impact"]["matching_mass_kg"], "kg (the target stops)"),
        ]
    width = max(len(label) for label, _, _ in rows)
    direction = ", ".join(f"{x:g}" for x in answer["direction"])
    head = [
        f"{answer['robot']}, felt at {answer['frame']}, along ({direction})",
        held,
        ", ".join(pose),
        "",
    ]
    body = [f"  {label:<{width}}  {_figure(value):>12} {unit}" for label, value, unit in rows]
    return "\n".join([*head, *body, *(f"note: {text}" for text in answer["notes"])])


def response_table(response: ApparentMass) -> str:
    """Apparent mass over frequency as CSV with units in the column names."""
    lines = ["frequency_Hz,omega_rad_s,magnitude_kg,phase_rad,mobility_real_per_kg,mobility_imag_per_kg"]
    for w, magnitude, phase, mobility in zip(
        response.omega, response.magnitude, response.phase, response.mobility, strict=True
    ):
        values = (w / (2.0 * math.pi), w, magnitude, phase, mobility.real, mobility.imag)
        lines.append(",".join(f"{x:.12g}" for x in values))
    return "\n".join(lines) + "\n"


def _apparent(result: EffectiveMass) -> dict[str, float] | None:
    if result.omega_rad_s is None:
        return None
    finite = math.isfinite(result.effective_mass_kg)
    mass = result.apparent_mass_kg if finite else complex(math.inf, 0.0)
    return {
        "omega_rad_s": result.omega_rad_s,
        "frequency_Hz": result.omega_rad_s / (2.0 * math.pi),
        "magnitude_kg": result.effective_mass_kg,
        "phase_rad": result.phase_rad,
        "real_kg": mass.real,
        "imaginary_kg": mass.imag,
    }


def _impact(impact: Impact) -> dict[str, Any]:
    return {
        "target_mass_kg": impact.target_mass_kg,
        "approach_speed_m_s": impact.approach_speed_m_s,
        "restitution": impact.restitution,
        "impulse_Ns": impact.impulse_Ns,
        "reduced_mass_kg": impact.reduced_mass_kg,
        "matching_mass_kg": matching_mass(impact.target_mass_kg, impact.restitution),
        "frame_velocity_jump": impact.frame_velocity_jump,
        "base_velocity_jump": impact.base_velocity_jump,
        "target_velocity_jump_m_s": impact.target_linear_jump_m_s,
    }


def _matrix(values: np.ndarray | None) -> Any:
    if values is None or not np.iscomplexobj(values):
        return values
    return {"real": values.real, "imaginary": values.imag}


def _figure(value: float | None) -> str:
    if value is None:
        return "-"
    return "infinite" if math.isinf(value) else f"{value:.6g}"
