"""What a mechanism's laws say at many states, as the balances use them: its kernels, and how its contact pushes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spacerobot.effects.kernel import Kernel, padded
from spacerobot.effects.mechanism import Mechanism

_PROBES = ((1e-3, 0.0), (-2e-3, 3e-2), (5e-2, -0.4), (0.3, 1.7))


def linear_coefficients(kernel: Kernel, p: tuple[float, ...]) -> tuple[float, float] | None:
    """(per displacement, per rate) of a law f = a d + b v; None where it is not of that form."""
    q = padded(p)
    a = kernel.force(1.0, 0.0, 0.0, q) - kernel.force(0.0, 0.0, 0.0, q)
    b = kernel.force(0.0, 1.0, 0.0, q) - kernel.force(0.0, 0.0, 0.0, q)
    for d, v in _PROBES:
        expected = a * d + b * v
        found = kernel.force(d, v, 0.0, q)
        if abs(found - expected) > 1e-9 * max(abs(a * d), abs(b * v), 1e-300):
            return None
    return float(a), float(b)


def values(
    kernel: Kernel, p: tuple[float, ...], d: np.ndarray, v: np.ndarray, aux: np.ndarray | None = None
) -> np.ndarray:
    """The law at many states, shape (N,)."""
    q = padded(p)
    extra = np.zeros_like(d) if aux is None else aux
    return np.array([kernel.force(float(x), float(y), float(z), q) for x, y, z in zip(d, v, extra, strict=True)])


def slopes(
    kernel: Kernel, p: tuple[float, ...], d: np.ndarray, v: np.ndarray, aux: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives by displacement and rate at many states, shape (N,) each, by central differences."""
    hd = 1e-4 * max(float(np.abs(d).max(initial=0.0)), 1e-6)
    hv = 1e-4 * max(float(np.abs(v).max(initial=0.0)), 1e-6)
    by_d = (values(kernel, p, d + hd, v, aux) - values(kernel, p, d - hd, v, aux)) / (2.0 * hd)
    by_v = (values(kernel, p, d, v + hv, aux) - values(kernel, p, d, v - hv, aux)) / (2.0 * hv)
    return by_d, by_v


def depth_of(kernel: Kernel, p: tuple[float, ...]) -> Callable[[np.ndarray], np.ndarray]:
    """Penetration [m] at which a resting contact presses with given forces [N]: the law read backwards."""
    depth = np.concatenate([[0.0], np.logspace(-8.0, -1.0, 281)])
    force = -values(kernel, p, depth, np.zeros_like(depth))
    rising = np.maximum.accumulate(force)
    return lambda wanted: np.interp(np.maximum(wanted, 0.0), rising, depth)


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
