"""Whether a body can exist: positive mass, positive definite inertia, triangle inequality."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spacerobot.support.errors import InputError

TRIANGLE_TOLERANCE = 1e-6
"""Relative to the largest principal moment; published URDFs are rounded."""


def inertia_fault(mass: float, inertia: np.ndarray) -> str | None:
    """What is impossible about a body, or None.

    Args:
        mass: [kg].
        inertia: shape (3, 3), about the centre of mass [kg m^2].
    """
    if not (np.isfinite(mass) and np.all(np.isfinite(inertia))):
        return "mass or inertia is not finite"
    if mass <= 0:
        return f"mass {mass:.6g} kg is not positive"
    low, middle, high = np.linalg.eigvalsh(0.5 * (inertia + inertia.T))
    if low <= 0:
        return f"inertia is not positive definite (principal moments {low:.6g}, {middle:.6g}, {high:.6g} kg m^2)"
    if low + middle < high * (1 - TRIANGLE_TOLERANCE):
        return (
            f"inertia breaks the triangle inequality by {1 - (low + middle) / high:.3g} "
            f"(principal moments {low:.6g}, {middle:.6g}, {high:.6g} kg m^2)"
        )
    return None


def moving_links(model: pin.Model, joint: int) -> list[str]:
    """Links that move with a joint: its own first, then those fixed to it."""
    return [f.name for f in model.frames if f.type == pin.FrameType.BODY and f.parentJoint == joint]


def inertia_faults(model: pin.Model) -> dict[str, str]:
    """Impossible bodies: link -> what is wrong with it, fixed links lumped into the moving one.

    A massless frame is legal, for it is lumped; a massless body behind a moving joint is not.
    """
    faults = {}
    for joint in range(1, model.njoints):
        body = model.inertias[joint]
        fault = inertia_fault(body.mass, body.inertia)
        if fault:
            links = moving_links(model, joint)
            faults[links[0] if links else model.names[joint]] = fault
    return faults


def require_possible(model: pin.Model, where: str) -> None:
    """Refuse a model with an impossible body.

    Raises:
        InputError: names the links at fault, up to three.
    """
    faults = inertia_faults(model)
    if faults:
        listed = [f"link {link!r}: {fault}" for link, fault in faults.items()]
        text = "; ".join(listed[:3]) + (f"; and {len(listed) - 3} more" if len(listed) > 3 else "")
        raise InputError(f"robot has a body that cannot exist: {text}", where=where)
