"""What is said of a run that was given up on its way."""

from __future__ import annotations

from spacerobot.support.errors import SimulationError


def too_many(model: str, what: str, time: float, end: float) -> SimulationError:
    """Too many steps or events, and what to do about it.

    Args:
        model: "reduced" or "multibody".
        what: "steps" or "events".
        time: how far it came [s].
        end: how far it should have come [s].
    """
    return SimulationError(
        f"{model} model: too many {what} at t = {time:.6g} s of {end:.6g} s: it swings or chatters for too long; "
        "give a shorter duration, more damping of wrist and contact, or a softer contact"
    )
