"""Front door: the collisions of many vectors of numbers, and what came of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacerobot.simulation.arrival import arrival_time
from spacerobot.simulation.exact import propagate as p
from spacerobot.simulation.exact.structure import OUTLINE, Structure
from spacerobot.support.errors import InputError, SimulationError


@dataclass(frozen=True, eq=False)
class Collisions:
    """What came of B collisions, shape (B,) each; NaN where it is not defined.

    Attributes:
        restitution_target, restitution_hand, restitution_point: see `simulation.restitution`.
        first_touch, contact_time, contact_time_summed: [s].
        touches: how often.
        peak_force: of the contact [N].
        peak_deflection: of the wrist, pushed in [m].
        target_velocity, hand_velocity: at the end [m/s].
        end: of the run [s].
    """

    restitution_target: np.ndarray
    restitution_hand: np.ndarray
    restitution_point: np.ndarray
    first_touch: np.ndarray
    contact_time: np.ndarray
    contact_time_summed: np.ndarray
    touches: np.ndarray
    peak_force: np.ndarray
    peak_deflection: np.ndarray
    target_velocity: np.ndarray
    hand_velocity: np.ndarray
    end: np.ndarray


def durations(structure: Structure, numbers: np.ndarray) -> np.ndarray:
    """Arrival and four times the predicted contact [s], shape (B,), as `simulate.default_duration` has it.

    The contact is half a period of the reduced model, the longest that it can be.

    Raises:
        InputError: a collision for which no end can be predicted.
    """
    lumped, stiffness, travel, closing, hand, tie, pull = numbers[:, structure.size - len(OUTLINE) :].T
    with np.errstate(divide="ignore", invalid="ignore"):
        held = tie > 0.0
        mass = np.where(held, lumped, lumped / (1.0 + lumped / hand))
        spring = np.where(held, 1.0 / (1.0 / stiffness + 1.0 / tie), stiffness)
        end = arrival_time(travel, closing, pull) + 4.0 * math.pi / np.sqrt(spring / mass)
    bad = ~(np.isfinite(end) & (stiffness > 0.0))
    if bad.any():
        raise InputError(
            "no contact time can be predicted for a collision",
            given=f"collision {int(np.argmax(bad))}",
            valid="wrist stiffness and closing speed (or a pull) above zero, or a duration",
        )
    return end


def collide(structure: Structure, numbers: np.ndarray, duration: float | None = None) -> Collisions:
    """Run collisions of one structure.

    Args:
        structure: what they share.
        numbers: shape (B, structure.size), see `Structure`.
        duration: [s]; long enough for the predicted contact if None.

    Raises:
        InputError: numbers of another shape, a mass that is not positive, or no end that could be predicted.
        SimulationError: a collision that could not be finished.
    """
    numbers = np.ascontiguousarray(numbers, dtype=float)
    if numbers.ndim != 2 or numbers.shape[1] != structure.size:
        raise InputError("numbers of the wrong shape", given=numbers.shape, valid=f"(B, {structure.size})")
    n = len(structure.coordinates)
    if not (numbers[:, :n] > 0.0).all():
        raise InputError("masses must be positive", given=float(numbers[:, :n].min()))
    ends = durations(structure, numbers) if duration is None else np.full(len(numbers), float(duration))
    out = np.empty((len(numbers), p.OUTPUTS))
    p.collide(*structure.packed(), numbers, ends, out)
    failed = np.flatnonzero(out[:, p.STATUS] != p.OK)
    if failed.size:
        why = "too many steps or events" if out[failed[0], p.STATUS] == p.TOO_MANY else "the state is not finite"
        raise SimulationError(f"exact propagation: {why} in collision {failed[0]} of this batch")
    return _results(out, ends)


def _results(out: np.ndarray, ends: np.ndarray) -> Collisions:
    before_hand, before_target, before_closing = out[:, p.HAND_BEFORE : p.CLOSING_BEFORE + 1].T
    after_hand, after_target, after_closing = out[:, p.HAND_AFTER : p.CLOSING_AFTER + 1].T
    approach = before_target - before_hand
    met = np.isfinite(out[:, p.LAST_SEPARATION]) & (before_closing > 0.0) & (approach > 0.0)
    nan = np.full(len(out), np.nan)

    def over(value: np.ndarray, by: np.ndarray) -> np.ndarray:
        return np.divide(value, by, out=nan.copy(), where=met)

    return Collisions(
        restitution_target=over(before_hand - after_target, approach),
        restitution_hand=over(after_hand - after_target, approach),
        restitution_point=over(-after_closing, before_closing),
        first_touch=out[:, p.FIRST_TOUCH],
        contact_time=out[:, p.LAST_SEPARATION] - out[:, p.FIRST_TOUCH],
        contact_time_summed=out[:, p.SUMMED],
        touches=out[:, p.TOUCHES].astype(np.int32),
        peak_force=out[:, p.PEAK_FORCE],
        peak_deflection=out[:, p.PEAK_DEFLECTION],
        target_velocity=out[:, p.FINAL_TARGET],
        hand_velocity=out[:, p.FINAL_HAND],
        end=ends,
    )
