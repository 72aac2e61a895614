"""Which way a disc of friction begins to slide."""

from __future__ import annotations

import numpy as np

from spacerobot.simulation.multibody.dynamics import Dynamics

HALVINGS = 200
"""Of the bracket of a multiplier; it narrows to the last bit long before."""


def start_heading(dynamics: Dynamics, r: int, t: float, y: np.ndarray, slope: np.ndarray) -> None:
    """Sets the heading of friction `r` and its mate, at rest and about to slide in state y.

    The sliding accelerates by a = b + W f where nothing else gives way, and the force opposes it with all that its
    limit has. So a is tried with no force and with a force along either axis, which says what b and W are.

    Args:
        dynamics: its modes have `r` sliding; its heading is set.
        r: of the lead.
        t, y: time [s] and ambient state.
        slope: overwritten, shape of y.
    """
    both = [r, int(dynamics.mates[r])]
    ports = [dynamics.mechanism.frictions[i].port for i in both]

    def accelerations(heading: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
        dynamics.heading[both] = heading
        dynamics.rate(t, y, slope)
        free = slope[dynamics.nq : dynamics.nq + dynamics.nv]
        found = np.array([dynamics.port_row(p) @ free + dynamics.port_bias(p) for p in ports])
        return found, np.array([dynamics.friction_force(i) for i in both])

    b, _ = accelerations((0.0, 0.0))
    one, force = accelerations((1.0, 0.0))
    two, _ = accelerations((0.0, 1.0))
    limit = abs(float(force[0]))
    size = float(np.hypot(*b))
    if limit == 0.0 or size == 0.0:
        dynamics.heading[both] = b / size if size > 0.0 else 0.0
        return
    dynamics.heading[both] = -against(b, np.column_stack([b - one, b - two]) / limit, limit) / limit


def against(b: np.ndarray, give: np.ndarray, limit: float) -> np.ndarray:
    """The force of size `limit` that opposes the acceleration b + give f which it leaves, shape (2,).

    It is -(give + m 1)^-1 b with the m > 0 that gives it its size: b + give f = -m f. Maximum dissipation over the
    disc; Moreau (1988), Unilateral contact and dry friction in finite freedom dynamics, section 5.

    Args:
        b: acceleration without the force, shape (2,), more than a force below the limit could undo.
        give: acceleration per force, symmetric and positive, shape (2, 2).
        limit: [N], positive.
    """
    low, high = 0.0, float(np.hypot(*b)) / limit
    middle = high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        force = np.linalg.solve(give + middle * np.eye(2), -b)
        if float(np.hypot(*force)) > limit:
            low = middle
        else:
            high = middle
        if high - low <= 1e-15 * high:
            break
    force = np.linalg.solve(give + high * np.eye(2), -b)
    return np.asarray(force * (limit / float(np.hypot(*force))))
