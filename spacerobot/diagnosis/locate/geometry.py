"""How a contact pushes on the coordinates, and how deep it is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spacerobot.effects.mechanism import Mechanism

WRIST, TARGET, YAW = "wrist", "target", "target.yaw"


def push(mechanism: Mechanism, yaw: Callable[[np.ndarray], np.ndarray], times: np.ndarray) -> dict[str, np.ndarray]:
    """Generalised force on each coordinate per newton of contact force, shape (N,) each [1, or m for the yaw].

    The penetration is d = x_B + a (cos psi - 1) - b sin psi - x_A (see `Contact`); a compressive force pushes
    along -d.

    Args:
        mechanism: with a contact.
        yaw: psi at given times [rad].
        times: shape (N,) [s].
    """
    contact = mechanism.contact
    if contact is None:
        return {}
    one = np.ones(times.shape)
    out = {WRIST: one, TARGET: -one}
    if YAW in mechanism.coordinates:
        psi = yaw(times)
        out[YAW] = contact.ahead * np.sin(psi) + contact.lateral * np.cos(psi)
    return {c: v for c, v in out.items() if c in mechanism.coordinates}


def bulge(mechanism: Mechanism, psi: np.ndarray) -> np.ndarray:
    """The yaw's part of the penetration, a (cos psi - 1) - b sin psi, shape of psi [m]."""
    contact = mechanism.contact
    if contact is None:
        return np.zeros_like(psi)
    return np.asarray(contact.turned(psi)[0])
