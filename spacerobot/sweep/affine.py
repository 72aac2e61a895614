"""The numbers of a linear rig as affine functions of what is swept, found by making a few scenes, not thousands.

Masses, springs, dampers, levels and starts are what they are in the scene, or sums of them; where that is so, one
matrix replaces making a scene for every collision. Where it is not (a wrist's mass that the effective mass of a
moving arm depends on), the scene is made anew for every value.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spacerobot.simulation.exact.structure import OUTLINE, Structure, piecewise_linear
from spacerobot.simulation.scene import Scene
from spacerobot.sweep.keys import with_values

TOLERANCE = 1e-12
"""Of the check at a third point, relative to the largest of the numbers compared."""


@dataclass(frozen=True, eq=False)
class Affine:
    """numbers = base + sum over keys of (value - reference) * gain.

    Attributes:
        structure: of the rig.
        keys: that it is a function of.
        reference: their values at base, shape (K,).
        base: shape (structure.size,).
        gain: shape (K, structure.size).
    """

    structure: Structure
    keys: tuple[str, ...]
    reference: np.ndarray
    base: np.ndarray
    gain: np.ndarray

    def numbers(self, values: np.ndarray) -> np.ndarray:
        """Numbers at values shape (B, K), shape (B, structure.size); summed key by key, alike on every machine."""
        found = np.tile(self.base, (len(values), 1))
        for k in range(len(self.keys)):
            used = np.flatnonzero(self.gain[k])
            found[:, used] += (values[:, k] - self.reference[k])[:, None] * self.gain[k, used]
        return found

    @property
    def hand_mass(self) -> float:
        """Of the rig [kg]; infinite where the arm is held."""
        return float(self.base[self.structure.size - len(OUTLINE) + OUTLINE.index("hand_mass")])


def affine(scene: Scene, pose: tuple[float, ...], fixed: dict[str, float], varied: dict[str, float]) -> Affine:
    """The function at a pose.

    Args:
        scene: of the sweep.
        pose: [rad or m].
        fixed: keys that have one value here.
        varied: keys that it is a function of, with a value in the middle of their range.

    Raises:
        NotLinearError: the scene is not piecewise linear.
        InputError: numbers that make no scene.
    """
    structure, base = piecewise_linear(with_values(scene, {**fixed, **varied}, pose))
    gains = []
    for key, value in varied.items():
        moved = _moved(value)
        _, other = piecewise_linear(with_values(scene, {**fixed, **varied, key: moved}, pose))
        change = np.zeros_like(base)
        np.subtract(other, base, out=change, where=np.isfinite(base))  # an infinite mass stays what it is
        change[np.abs(change) <= 1e-14 * np.abs(base)] = 0.0
        gains.append(change / (moved - value))
    return Affine(
        structure,
        tuple(varied),
        np.array(list(varied.values())),
        base,
        np.array(gains).reshape(len(varied), structure.size),
    )


def not_affine(scene: Scene, pose: tuple[float, ...], varied: dict[str, float]) -> tuple[str, ...]:
    """Keys in which the numbers are not affine, alone or together with others.

    Raises:
        NotLinearError: the scene is not piecewise linear.
    """
    bad = []
    for key, value in varied.items():
        rest = {k: v for k, v in varied.items() if k != key}
        function = affine(scene, pose, rest, {key: value})
        if not _agrees(function, scene, pose, rest, {key: _moved(value, 0.3)}):
            bad.append(key)
    good = {k: v for k, v in varied.items() if k not in bad}
    rest = {k: varied[k] for k in bad}
    together = {k: _moved(v, 0.1 + 0.07 * i) for i, (k, v) in enumerate(good.items())}
    if good and not _agrees(affine(scene, pose, rest, good), scene, pose, rest, together):
        return tuple(varied)
    return tuple(bad)


def _moved(value: float, share: float = 0.25) -> float:
    """Another value nearby that makes a scene where this one does."""
    return value * (1.0 + share) if value else share * 1e-3


def _agrees(
    function: Affine, scene: Scene, pose: tuple[float, ...], fixed: dict[str, float], varied: dict[str, float]
) -> bool:
    structure, exact = piecewise_linear(with_values(scene, {**fixed, **varied}, pose))
    if structure != function.structure:
        return False
    found = function.numbers(np.array([list(varied.values())]))[0]
    finite = np.isfinite(exact) & np.isfinite(found)
    off = np.abs(found[finite] - exact[finite]) > TOLERANCE * np.maximum(np.abs(exact), np.abs(function.base))[finite]
    return not off.any() and bool((np.isfinite(exact) == np.isfinite(found)).all())
