"""Laws that no catalogue holds, at one port each: what a diagnosis should learn where it cannot name.

Their forms are this file's own; only the port and what a law depends on are ever compared with what was learned.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from spacerobot.proof.engine.rig import Rig

Numbers = Mapping[str, float]

Curve = Callable[[float, Numbers], float]
"""(displacement [m], rate [m/s] or normal force [N]; the law's numbers) -> force [N] against it."""


@dataclass(frozen=True)
class HiddenLaw:
    """One of them.

    Attributes:
        where: port.
        kind: "force" (f = -curve) or "friction" (a level, with sticking).
        of: what the curve depends on: "d", "v" or "N".
        curve: the law.
        numbers: of a size s, drawn once; all but the first are alike at every size.
    """

    where: str
    kind: str
    of: str
    curve: Curve
    numbers: Callable[[np.random.Generator, float], Callable[[float], dict[str, float]]]


def _valve(v: float, p: Numbers) -> float:
    """A damper that a valve closes on one stroke, not all at once."""
    way, soft = p["way"], p["soft_m_s"]
    return p["coefficient_Ns_m"] * way * 0.5 * (way * v + math.sqrt(v * v + soft * soft) - soft)


def _saturating(v: float, p: Numbers) -> float:
    """A seal that drags, and at speed no more than it did."""
    return p["force_N"] * math.tanh(v / p["velocity_m_s"])


def _magnet(d: float, p: Numbers) -> float:
    """A magnet beside the guide or under the table that pulls towards its place."""
    u = (d - p["place_m"]) / p["width_m"]
    return p["force_N"] * u * math.exp(0.5 - 0.5 * u * u)


def _worn(d: float, p: Numbers) -> float:
    """A guide that is worn at one place."""
    return p["force_N"] * math.exp(-(((d - p["place_m"]) / p["width_m"]) ** 2))


def _rising(d: float, p: Numbers) -> float:
    """A guide that grips more, the further in."""
    return p["force_N"] * (d / p["reach_m"]) ** 2


def _pressed(n: float, p: Numbers) -> float:
    """A guide under load."""
    return p["mu"] * n


def _stiffening(d: float, p: Numbers) -> float:
    """A tip that grows stiff beyond a depth."""
    return p["force_N"] * (max(d, 0.0) / p["depth_m"]) ** 3


def _way(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    way, soft = float(rng.choice([-1.0, 1.0])), float(rng.uniform(0.001, 0.01))
    return lambda s: {"coefficient_Ns_m": s, "way": way, "soft_m_s": soft}


def _drag(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    speed = float(rng.uniform(0.01, 0.04))
    return lambda s: {"force_N": 0.1 * s, "velocity_m_s": speed}


def _at(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    place, width = float(rng.uniform(0.3, 0.7)) * reach, float(rng.uniform(0.1, 0.3)) * reach
    return lambda s: {"force_N": 0.2 * s, "place_m": place, "width_m": width}


def _under(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    place, width = float(rng.uniform(-0.03, 0.0)), float(rng.uniform(0.01, 0.03))
    return lambda s: {"force_N": 0.05 * s, "place_m": place, "width_m": width}


def _further(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    return lambda s: {"force_N": 0.2 * s, "reach_m": reach}


def _share(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    return lambda s: {"mu": 0.01 * s}


def _deep(rng: np.random.Generator, reach: float) -> Callable[[float], dict[str, float]]:
    depth = float(rng.uniform(1e-4, 2e-4))
    return lambda s: {"force_N": 0.2 * s, "depth_m": depth}


LAWS: dict[str, HiddenLaw] = {
    "valve": HiddenLaw("wrist", "force", "v", _valve, _way),
    "saturating": HiddenLaw("wrist", "force", "v", _saturating, _drag),
    "catch": HiddenLaw("wrist", "force", "d", _magnet, _at),
    "worn": HiddenLaw("wrist", "friction", "d", _worn, _at),
    "rising": HiddenLaw("wrist", "friction", "d", _rising, _further),
    "loaded": HiddenLaw("wrist", "friction", "N", _pressed, _share),
    "stiffening": HiddenLaw("contact", "force", "d", _stiffening, _deep),
    "field": HiddenLaw("target", "force", "d", _magnet, _under),
}
"""Name -> law."""

LARGEST = 200.0
"""Size beyond which none is tried."""


def _edit(law: HiddenLaw) -> Callable[[Rig, str, Numbers], None]:
    def edit(rig: Rig, where: str, p: Numbers) -> None:
        if where == "contact":
            rig.contact.further = lambda d: law.curve(d, p)
            return
        i, of = rig.index[where], law.of
        if law.kind == "friction":
            rig.levels[where] = lambda v, net, q, f: max(law.curve(q if of == "d" else f, p), 0.0)
            return

        def force(q: list[float], v: list[float], t: float, f: float, out: list[float]) -> None:
            out[i] -= law.curve(q[i] if of == "d" else v[i], p)

        rig.laws.append(force)

    return edit


EDITS = {name: _edit(law) for name, law in LAWS.items()}
"""Name -> what it does to the rig."""
