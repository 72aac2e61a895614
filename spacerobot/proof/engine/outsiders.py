"""Physics that no catalogue of ours holds: what an honest diagnosis must call unknown."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from spacerobot.proof.engine.rig import Rig


def magnetic_pull(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """Tip and target attract each other: F0 / (1 + gap/L)^2, full while they touch."""
    at, strength, length = rig.index, p["force_N"], p["length_m"]
    target, wrist, hand = at["target"], at["wrist"], at.get("hand")

    def law(q: list[float], v: list[float], t: float, f: float, out: list[float]) -> None:
        tip = q[wrist] + (q[hand] if hand is not None else 0.0)
        gap = max(tip - q[target], 0.0)
        pull = strength / (1.0 + gap / length) ** 2
        out[target] += pull
        out[wrist] -= pull
        if hand is not None:
            out[hand] -= pull

    rig.laws.append(law)


def one_sided_damping(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A damper that acts only while the slider is pushed in (a check valve)."""
    i, c = rig.index[where], p["coefficient_Ns_m"]

    def law(q: list[float], v: list[float], t: float, f: float, out: list[float]) -> None:
        if v[i] > 0.0:
            out[i] -= c * v[i]

    rig.laws.append(law)


def warming_spring(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A spring whose stiffness drifts from trial to trial, towards a plateau."""
    share = p["share"] * (1.0 - math.exp(-rig.trial / p["trials"]))
    rig.joints[where].stiffness *= 1.0 + share


def periodic_cable(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A cable that swings and pulls in time, its phase another in every trial."""
    i, force, omega = rig.index[where], p["force_N"], 2.0 * math.pi * p["frequency_Hz"]
    phase = 2.399963 * rig.trial  # the golden angle: spread evenly, never repeated

    rig.laws.append(lambda q, v, t, f, out: _add(out, i, force * math.sin(omega * t + phase)))


def cogging(rig: Rig, where: str, p: Mapping[str, float]) -> None:
    """A guide that pulls towards evenly spaced positions, as magnets and ball chains do."""
    i, force, pitch = rig.index[where], p["force_N"], p["pitch_m"]
    rig.laws.append(lambda q, v, t, f, out: _add(out, i, -force * math.sin(2.0 * math.pi * q[i] / pitch)))


def _add(out: list[float], i: int, force: float) -> None:
    out[i] += force


OUTSIDERS: dict[str, Callable[[Rig, str, Mapping[str, float]], None]] = {
    "magnetic_pull": magnetic_pull,
    "one_sided_damping": one_sided_damping,
    "warming_spring": warming_spring,
    "periodic_cable": periodic_cable,
    "cogging": cogging,
}
