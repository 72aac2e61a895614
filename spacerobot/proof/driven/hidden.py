"""What an arm's joints can hide: for each effect its numbers at a size, and what it does to the arm in MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from spacerobot.proof.driven.arm import Built, joints
from spacerobot.proof.engine.missing import Missing
from spacerobot.proof.engine.physics import two_levels

Values = dict[str, float]
Drawn = Callable[[float], Values]
"""Size -> parameters; the amount is in proportion to the size."""

STRENGTH = {"S1": 1.0, "S2": 1.0, "S3": 0.5, "E1": 0.5, "E2": 0.15, "W1": 0.15, "W2": 0.15}
"""How large [N m] an ordinary torque of friction is, by joint."""


def _coulomb(unit: float, rng: np.random.Generator) -> Drawn:
    return lambda s: {"force_Nm": unit * s}


def _viscous(unit: float, rng: np.random.Generator) -> Drawn:
    return lambda s: {"coefficient_Nms_rad": 2.0 * unit * s}


def _quadratic(unit: float, rng: np.random.Generator) -> Drawn:
    return lambda s: {"coefficient_Nms2_rad2": 4.0 * unit * s}


def _asymmetric(unit: float, rng: np.random.Generator) -> Drawn:
    ratio = math.exp(float(rng.choice([-1.0, 1.0]) * rng.uniform(0.35, 0.6)))
    return lambda s: {"force_plus_Nm": unit * ratio * s, "force_minus_Nm": unit / ratio * s}


def _ripple(unit: float, rng: np.random.Generator) -> Drawn:
    count = float(rng.integers(12, 30))
    return lambda s: {"torque_Nm": unit * s, "per_rad": count}


DRAWS: dict[str, Callable[[float, np.random.Generator], Drawn]] = {
    "coulomb_friction": _coulomb,
    "viscous_friction": _viscous,
    "quadratic_damping": _quadratic,
    "asymmetric_friction": _asymmetric,
    "torque_ripple": _ripple,
}
"""Effect -> how its numbers are drawn."""

OUTSIDE = ("torque_ripple",)
"""What no catalogue of ours holds: a torque that changes with the angle many times a turn, as gears and poles do."""

KNOWN = tuple(name for name in DRAWS if name not in OUTSIDE)


def draw(effect: str, joint: str, rng: np.random.Generator) -> Callable[[float], Missing]:
    """The effect at a joint, by size; its further numbers are drawn."""
    drawn = DRAWS[effect](STRENGTH[joint], rng)
    return lambda size: Missing(effect, f"joint.{joint}", drawn(size))


def hide(built: Built, item: Missing) -> None:
    """Put an effect into the arm: MuJoCo's own friction and damping where it has them."""
    EDITS[item.effect](built, item.where.removeprefix("joint."), item.values)


def torque(item: Missing, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """The torque of an effect along a motion, shape (T,) [N m]: positive where the drive must overcome it."""
    k, p = joints().index(item.where.removeprefix("joint.")), item.values
    v = velocity[:, k]
    if item.effect == "coulomb_friction":
        return p["force_Nm"] * np.sign(v)
    if item.effect == "viscous_friction":
        return p["coefficient_Nms_rad"] * v
    if item.effect == "quadratic_damping":
        return p["coefficient_Nms2_rad2"] * np.abs(v) * v
    if item.effect == "asymmetric_friction":
        return np.where(v > 0.0, p["force_plus_Nm"], -p["force_minus_Nm"])
    return p["torque_Nm"] * np.sin(p["per_rad"] * position[:, k])


def _dry(built: Built, joint: str, p: Mapping[str, float]) -> None:
    built.friction[joint] = built.friction.get(joint, 0.0) + p["force_Nm"]


def _damped(built: Built, joint: str, p: Mapping[str, float]) -> None:
    built.damping[joint] = built.damping.get(joint, 0.0) + p["coefficient_Nms_rad"]


def _squared(built: Built, joint: str, p: Mapping[str, float]) -> None:
    k, c = joints().index(joint), p["coefficient_Nms2_rad2"]
    built.laws.append((joint, lambda q, v, t: -c * abs(float(v[k])) * float(v[k])))


def _two_levels(built: Built, joint: str, p: Mapping[str, float]) -> None:
    built.levels[joint] = two_levels(p["force_plus_Nm"], p["force_minus_Nm"])


def _rippled(built: Built, joint: str, p: Mapping[str, float]) -> None:
    k, force, count = joints().index(joint), p["torque_Nm"], p["per_rad"]
    built.laws.append((joint, lambda q, v, t: -force * math.sin(count * float(q[k]))))


EDITS: dict[str, Callable[[Built, str, Mapping[str, float]], None]] = {
    "coulomb_friction": _dry,
    "viscous_friction": _damped,
    "quadratic_damping": _squared,
    "asymmetric_friction": _two_levels,
    "torque_ripple": _rippled,
}
"""Effect -> what it does to the arm."""
