"""What is said of a run that was given up on its way."""

from __future__ import annotations

import math
from collections.abc import Callable

from spacerobot.effects.laws import DAMPER
from spacerobot.effects.mechanism import Mechanism
from spacerobot.support.errors import SimulationError

SOFTER = "more damping of wrist and contact, or a softer contact"


def too_many(model: str, what: str, time: float, end: float, advice: str) -> SimulationError:
    """Too many steps or events, and what to do about it.

    Args:
        model: "reduced" or "multibody".
        what: "steps" or "events".
        time: how far it came [s].
        end: how far it should have come [s].
        advice: of `remedy`.
    """
    return SimulationError(f"{model} model: too many {what} at t = {time:.6g} s of {end:.6g} s: {advice}")


def remedy(mechanism: Mechanism, give: Callable[[str], float]) -> str:
    """What makes a run slow, and what would help: the fastest of its servos, or its contact.

    A spring k on a port that gives w per unit of force swings at sqrt(k w), a damper c decays at c w: steps are as
    short as the fastest. More damping slows a contact's chatter, but makes a servo that is damped too much worse.

    Args:
        mechanism: its servos' forces are named so.
        give: port -> acceleration per force at the start [1/kg or 1/(kg m^2)].
    """
    fastest, worst, damped = 0.0, "", False
    for force in mechanism.forces:
        if ".servo_" in force.name and force.role and force.p:
            w = max(give(force.port), 0.0)
            rate = force.p[0] * w if force.kernel == DAMPER else math.sqrt(max(force.p[0], 0.0) * w)
            if rate > fastest:
                fastest, worst, damped = rate, force.name.split(".servo_")[0], force.kernel == DAMPER
    contact = mechanism.contact
    touch = 0.0
    if contact is not None:
        light = 1.0 / mechanism.coordinates["wrist"].mass + 1.0 / mechanism.coordinates["target"].mass
        touch = max(math.sqrt(contact.p[0] * light), contact.p[1] * light)
    elif not fastest:
        return "it swings or chatters for too long; give a shorter duration, or softer springs and dampers"
    if fastest <= touch:
        return f"it swings or chatters for too long; give a shorter duration, {SOFTER}"
    if damped:
        return (
            f"the servo of {worst} is damped so strongly that it decays at {fastest:.3g} 1/s, and every step is "
            'shorter than that; give a shorter duration, less servo damping, or joints = "locked" if they hardly move'
        )
    return (
        f"the servo of {worst} is so stiff that it swings at {fastest:.3g} rad/s, and every step is shorter than that; "
        'give a shorter duration, softer servos, or joints = "locked" if they hardly move'
    )
